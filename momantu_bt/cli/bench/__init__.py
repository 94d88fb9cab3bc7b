"""`momantu-bt bench` and `compare`: many runs of a tree."""
