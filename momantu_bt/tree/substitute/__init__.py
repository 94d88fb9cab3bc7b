"""Files that say what nodes do instead of themselves, for tests of trees."""
