"""What a linear model says: motions, forces, ellipsoids, and all of it in words."""
