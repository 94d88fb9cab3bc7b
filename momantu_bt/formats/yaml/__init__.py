"""YAML 1.2 as values that know their place: read without recursion and within bounds."""
