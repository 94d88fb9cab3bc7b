"""`momantu-bt check`, `convert` and `show`: tree files."""
