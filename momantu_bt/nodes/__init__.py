"""The built-in nodes: a file per family, each with what the language and the engine need of it."""
