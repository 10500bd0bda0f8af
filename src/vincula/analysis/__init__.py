"""Analyses of a linear model: mobility, equilibrium, manipulability, diagnosis."""
