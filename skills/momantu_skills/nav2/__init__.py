"""The leaves of Nav2's trees as skills: their names, ports and error codes, on our navigation."""
