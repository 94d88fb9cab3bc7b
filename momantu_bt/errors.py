"""Exit codes, and the base class of all errors that a user sees.

Only `main` catches such an error: it prints the error without a stack trace and ends with its exit
code. Any other exception is a mistake in the program: exit code INTERNAL.
"""

from __future__ import annotations

from enum import IntEnum
from typing import ClassVar

TRACEBACK = "MOMANTU_BT_TRACEBACK"
"""Environment variable: if it is set to anything, internal errors show their traceback."""


class ExitCode(IntEnum):
    """The exit code of a command line."""

    SUCCESS = 0
    """The tree succeeded and no referee denies it; the command did what was asked."""
    FAILURE = 1
    """The tree failed, the referee denies its success, or a check found something wrong."""
    WRONG_INPUT = 2
    """A file or an argument is wrong; nothing was started."""
    NO_WORLD = 3
    """The world could not start: `momantu_bt.world.WorldError`."""
    INTERNAL = 4
    """A mistake in the program or in a plug-in, or an output of a good run got lost."""
    INTERRUPTED = 130
    """Ctrl-C, SIGTERM or SIGHUP."""


class StopRequested(KeyboardInterrupt):
    """Ctrl-C or a signal such as SIGTERM ends the run now.

    Code of plug-ins may raise anything, `SystemExit` too. Whoever calls it catches BaseException
    and lets this one pass.
    """


PLUGIN_ERRORS = (Exception, SystemExit, GeneratorExit)
"""What code of a plug-in may raise before a run begins; Ctrl-C passes."""


class MomantuError(Exception):
    """Something that a person has to mend: the message says where, what was expected, what to do.

    exit_code: the exit code of the command line if this error reaches it.
    hint: one more line, printed below the message.
    """

    exit_code: ClassVar[ExitCode] = ExitCode.WRONG_INPUT

    def __init__(self, *arguments: object, hint: str | None = None) -> None:
        super().__init__(*arguments)
        self.hint = hint

    def printed(self) -> str:
        """The printed text: the message, and the hint on a separate line."""
        message = f"momantu-bt: {self}"
        return message if self.hint is None else f"{message}\n{self.hint}"


class InputError(MomantuError):
    """An argument, or a file that it names, is wrong; the message says what would be right."""


def words_of(error: BaseException) -> str:
    """`ValueError: too long`, on one line, also for an exception whose text cannot be made."""
    try:
        text = str(error)
    except Exception:
        text = "its text cannot be made"
    return (
        ": ".join([type(error).__name__, " ".join(text.split())]) if text else type(error).__name__
    )
