"""How often it works: many episodes of a tree, each a process, their rows, and what these say."""
