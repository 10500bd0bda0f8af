"""What `bench.py` measures side by side: the cases, our kernels, and the yardsticks."""
