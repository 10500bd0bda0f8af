"""Sweeps: many points, one labelled data set, a ledger that survives anything."""
