"""Helpers of several verbs: options, values, lists, schemas, notices and help."""
