"""`momantu-bt run`: the live tree, questions to a person, breakpoints."""
