"""Things on a surface: told apart, measured, compared with what is asked."""
