"""What several verbs use: options, values, lists, schemas, notices and help."""
