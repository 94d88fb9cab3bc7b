"""What fuzzing gives to the reader and the checker of tree files."""
