"""The site: places, surfaces and what hangs over them, and maps."""
