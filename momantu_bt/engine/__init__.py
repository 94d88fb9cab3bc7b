"""Running a tree: from its checked model to nodes and ticks."""
