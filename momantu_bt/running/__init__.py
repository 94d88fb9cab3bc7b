"""A run as a whole: from a tree's name and what is asked of its run to the report."""
