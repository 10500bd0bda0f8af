"""Numbers under everything: what is zero, subspaces, cosines and sines."""
