"""Our trees beside py_trees: its displays and visitors on ours, and ours inside its trees."""
