"""`momantu-bt robots` and its sub-verbs."""
