"""Substitutions: rules that replace nodes, for tests of trees."""
