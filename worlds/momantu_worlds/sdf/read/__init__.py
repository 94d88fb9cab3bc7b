"""SDF files as typed values, each with its place in the file."""
