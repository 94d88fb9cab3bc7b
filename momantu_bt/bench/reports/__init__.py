"""Report the results of a bench as text and as JSON."""
