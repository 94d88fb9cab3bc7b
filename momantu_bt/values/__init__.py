"""Values at ports: the kinds of types there are, and text, numbers and Python values as each."""
