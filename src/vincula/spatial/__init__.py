"""Spaces, poses, twists and the selectors of contacts and joints."""
