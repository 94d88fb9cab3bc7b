"""Files that describe a robot or a world: YAML with quantities, every mistake told at its place."""
