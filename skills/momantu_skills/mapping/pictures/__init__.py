"""Maps as pictures: files to look at, and text for a terminal."""
