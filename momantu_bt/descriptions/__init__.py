"""Files that describe robots and worlds: YAML with quantities, mistakes reported at their place."""
