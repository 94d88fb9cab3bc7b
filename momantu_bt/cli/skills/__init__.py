"""`momantu-bt skills` and its sub-verbs, a file each."""
