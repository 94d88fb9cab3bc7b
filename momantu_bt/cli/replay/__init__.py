"""`momantu-bt replay` and `diff`: recorded runs."""
