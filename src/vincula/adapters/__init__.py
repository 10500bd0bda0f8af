"""Live objects of other libraries, as linear models."""
