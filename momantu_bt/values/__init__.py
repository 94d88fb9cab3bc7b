"""Values at ports: types, conversion from text and YAML, and admission of skills' outputs."""
