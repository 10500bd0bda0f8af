"""The mechanism: parts, graph, reduction, kinematics, catalog."""
