"""The program's name, and the variable with which a shell asks it for completions."""

PROGRAM = "momantu-bt"
COMPLETE = "_MOMANTU_BT_COMPLETE"
"""A shell sets it to ask what can stand at the cursor; the name is typer's."""
