"""The command line: one file for each verb, imported when the verb is used.

Exit codes: 0 the tree succeeded and no referee denies it; 1 it failed, or something is wrong;
2 the tree or the arguments are wrong, and nothing was started; 3 the world could not start;
4 an internal error, or an output that got lost; 130 interrupted.
"""

from __future__ import annotations

import os
import re
import signal
import sys
from collections.abc import Sequence
from typing import Any

import typer

import momantu_bt.threads  # noqa: F401 - before numpy, which the next imports load
from momantu_bt import collector
from momantu_bt.cli.shared import streams
from momantu_bt.cli.shared.notices import notice
from momantu_bt.cli.shared.program import COMPLETE, PROGRAM
from momantu_bt.cli.subverbs import add_command, summary, with_subverbs
from momantu_bt.cli.verbs import COMMANDS, VERBS, built_in
from momantu_bt.errors import TRACEBACK, ExitCode, MomantuError, words_of
from momantu_bt.lazy import lazily
from momantu_bt.version import __version__

with lazily():
    from momantu_bt.cli import completion
    from momantu_bt.running import leftovers

_FOR_PROGRAMS = frozenset({"--json", "--sarif"})
"""Options whose output a program reads: nothing else may get into it."""
_UNKNOWN = re.compile(r"No such command '(?P<word>.*)'\.(?P<nearest> Did you mean)?")
"""Click's message about an unknown command of a group, with typer's addition."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command line and return its exit code; arguments default to the process's.

    A verb returns its exit code or raises; only this function reports what it raises.
    """
    if arguments is not None:
        return _main(list(arguments))
    streams.open_standard_streams(alone=not _FOR_PROGRAMS.isdisjoint(sys.argv))
    code = _main(sys.argv[1:])
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # too late: all that is left is to end
    leftovers.end_with(code)
    return code


@collector.seldom()
def _main(given: list[str]) -> int:
    try:
        if COMPLETE in os.environ:
            return completion.answer(_app(completion.words_to_complete()))
        if not given:
            _app(given)(args=["--help"], prog_name=PROGRAM, standalone_mode=False)
            return ExitCode.WRONG_INPUT
        result = _app(given)(args=given, prog_name=PROGRAM, standalone_mode=False)
    except KeyboardInterrupt:
        return ExitCode.INTERRUPTED
    except SystemExit as error:
        return _ended_early(error, given)
    except BrokenPipeError:
        # the reader of the output has gone, so nobody would see a message
        return ExitCode.FAILURE
    except MomantuError as error:
        typer.echo(error.printed(), err=True)
        return error.exit_code
    except BaseException as error:
        return _other_error(error)
    return result if isinstance(result, int) else ExitCode.SUCCESS


def _ended_early(error: SystemExit, given: Sequence[str]) -> int:
    """The exit code after `sys.exit`, which only a plug-in's verb may call; its own code holds."""
    words = [word for word in given if not word.startswith("-")]
    if words and any(name in COMMANDS for name in (words[0], " ".join(words[:2]))):
        return error.code if isinstance(error.code, int) else int(error.code is not None)
    return _other_error(error)


def _app(given: Sequence[str]) -> typer.Typer:
    """The command line with the verb ready that is given; the others are a line of help each."""
    at = next((n for n, word in enumerate(given) if not word.startswith("-")), None)
    verb, rest = (None, ()) if at is None else (given[at], given[at + 1 :])
    app = typer.Typer(
        name=PROGRAM,
        help="Program a mobile manipulator by editing one tree file.",
        rich_markup_mode=None,
        add_completion=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback(epilog="momantu-bt VERB --help shows worked examples.")(_options)
    for name, described in VERBS.items():
        if name == verb:
            own = built_in(name)
            add_command(app, name, with_subverbs(own, name, rest))
        else:
            app.command(name, help=described.summary)(_never)
    for name, entry in COMMANDS.installed().items():
        if name in VERBS or " " in name:
            continue
        if name == verb:
            own = COMMANDS.load(name)
            add_command(app, name, with_subverbs(own, name, rest))
        else:
            app.command(name, help=summary(entry))(_never)
    return app


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(__version__)
        raise typer.Exit


def _options(
    version: bool = typer.Option(
        False, "--version", is_eager=True, callback=_print_version, help="Print the version."
    ),
) -> None:
    """Options of the program itself."""


def _never() -> None:
    """A placeholder for a verb that was not given."""


def _other_error(error: BaseException) -> ExitCode:
    """Report a wrong command line, or a mistake in the program."""
    usage = _usage_message(error)
    if usage is not None:
        notice(usage)
        return ExitCode.WRONG_INPUT
    if os.environ.get(TRACEBACK):
        raise error
    notice(f"internal error: {words_of(error)} (set {TRACEBACK}=1 for the traceback)")
    return ExitCode.INTERNAL


def _usage_message(error: Any) -> str | None:
    """One line with the message and the command whose help to read; None for other errors.

    error: a usage error of typer, from the click version that typer was built with. It has
    `format_message()` and the `ctx` of the command that it happened in.
    """
    if getattr(error, "format_message", None) is None:
        return None
    message, context = str(error.format_message()), getattr(error, "ctx", None)
    path = PROGRAM if context is None else context.command_path
    message += "" if message.endswith((".", "?", "!")) else "."
    unknown = _UNKNOWN.match(message)
    if unknown is not None and context is not None and context.parent is not None:
        message += _instead(path, sorted(context.command.list_commands(context)), unknown)
    return f"{message} See {path} --help."


def _instead(path: str, known: list[str], unknown: re.Match[str]) -> str:
    """`momantu-bt worlds my_flat` wants to see a world, `worlds chek …` to check one."""
    can = f" {path} knows {', '.join(known)}."
    if "show" not in known or unknown["nearest"]:
        return can
    return f"{can} To see one: {path} show {unknown['word']}."
