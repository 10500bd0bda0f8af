"""Pictures: scenes of plain drawables, and matplotlib figures."""
