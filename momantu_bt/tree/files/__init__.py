"""Tree files: found, read in either spelling, joined by includes, and written."""
