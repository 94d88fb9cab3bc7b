"""`momantu-bt services` and its sub-verbs."""
