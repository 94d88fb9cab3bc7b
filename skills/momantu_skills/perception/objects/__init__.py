"""Objects on a surface: separated, measured, compared with the requested object."""
