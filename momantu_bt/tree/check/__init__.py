"""The checker: everything that is wrong with a tree file, before the first tick."""
