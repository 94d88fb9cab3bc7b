"""A tree or a skill as people and other programs see it: lines, pages, schemas, SARIF."""
