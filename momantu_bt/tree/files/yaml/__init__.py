"""Tree files in YAML: read into the model, and written from it."""
