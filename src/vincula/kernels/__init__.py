"""One mechanism at many configurations: compiled once, evaluated in batches, with or without numba."""
