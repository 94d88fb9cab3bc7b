"""A run as a whole: from a tree's name and its options to the report."""
