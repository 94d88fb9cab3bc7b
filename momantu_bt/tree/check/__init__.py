"""The checker: finds all mistakes of a tree file before the first tick."""
