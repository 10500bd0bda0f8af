"""Kernels over lanes: many configurations side by side in the arithmetic units of the processor (numba)."""
