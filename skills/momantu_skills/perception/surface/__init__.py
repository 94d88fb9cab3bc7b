"""The surface that objects stand on: its plane, the objects above it, free spots."""
