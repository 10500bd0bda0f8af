"""Design: which joints get the motors."""
