"""Messages about a wrong command line: what is wrong, and what would be right."""

from __future__ import annotations

import re
from typing import Any

UNKNOWN = re.compile(r"No such command '(?P<word>.*)'\.(?P<nearest> Did you mean)?")
"""What click says of a name that a group of commands does not have, with typer's addition."""


def usage_message(error: Any) -> str | None:
    """One line of the message and of whose help to read; None for other errors.

    error: one of typer's usage errors, of whichever click typer was built with: they have
    `format_message()`, and `ctx` of the command that they happened in.
    """
    if getattr(error, "format_message", None) is None:
        return None
    message, context = str(error.format_message()), getattr(error, "ctx", None)
    path = "momantu-bt" if context is None else context.command_path
    message += "" if message.endswith((".", "?", "!")) else "."
    unknown = UNKNOWN.match(message)
    if unknown is not None and context is not None and context.parent is not None:
        message += _instead(path, sorted(context.command.list_commands(context)), unknown)
    return f"{message} See {path} --help."


def _instead(path: str, known: list[str], unknown: re.Match[str]) -> str:
    """`momantu-bt worlds my_flat` wants to see a world, `worlds chek …` to check one."""
    can = f" {path} knows {', '.join(known)}."
    if "show" not in known or unknown["nearest"]:
        return can
    return f"{can} To see one: {path} show {unknown['word']}."
