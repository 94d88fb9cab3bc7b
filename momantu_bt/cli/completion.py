"""`momantu-bt completion`: completion in bash, zsh and fish.

typer completes verbs and options. The names that arguments may have (trees, worlds, robots, skills,
faults) are completed here, by the name of the parameter, also for verbs of other packages.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Iterable
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from typer import completion as typer_completion
from typer.main import get_command

from momantu_bt.cli.shared.program import COMPLETE, PROGRAM
from momantu_bt.errors import ExitCode
from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt import world_plugins
    from momantu_bt.faults.kinds import catalogue as faults
    from momantu_bt.robots import plugins as robots
    from momantu_bt.tree import plugins as skills
    from momantu_bt.tree.files import lookup


class Shell(StrEnum):
    """Shells for which there is a script."""

    bash = "bash"
    zsh = "zsh"
    fish = "fish"


def completion(
    shell: Annotated[Shell, typer.Argument(help="Your shell.")],
) -> None:
    """Print a script that lets your shell complete verbs, options and names.

    Examples:
      momantu-bt completion bash >> ~/.bashrc
      momantu-bt completion zsh >> ~/.zshrc
      momantu-bt completion fish > ~/.config/fish/completions/momantu-bt.fish
    """
    script = typer_completion.get_completion_script(  # type: ignore[attr-defined]
        prog_name=PROGRAM, complete_var=COMPLETE, shell=shell.value
    )
    typer.echo(script)


def words_to_complete() -> list[str]:
    """The words after the program's name on the shell's line."""
    line = os.environ.get("COMP_WORDS", os.environ.get("_TYPER_COMPLETE_ARGS", ""))
    try:
        return shlex.split(line)[1:]
    except ValueError:  # an open quote
        return line.split()[1:]


def answer(app: typer.Typer) -> ExitCode:
    """Print what can stand at the cursor, as the shell's script expects it."""
    command = get_command(app)
    _add_names(command, ())
    typer_completion.completion_init()  # type: ignore[attr-defined]
    instruction = os.environ[COMPLETE]
    code = typer_completion.shell_complete(command, {}, PROGRAM, COMPLETE, instruction)
    return ExitCode.SUCCESS if code == 0 else ExitCode.WRONG_INPUT


def _add_names(command: Any, verb: tuple[str, ...]) -> None:
    """Let each parameter of a command and its sub-commands complete the names that it may have."""
    for parameter in command.params:
        names = _NAMES.get(parameter.name) or _NAMES.get(" ".join((*verb[:1], parameter.name)))
        if names is not None:
            parameter._custom_shell_complete = _completer(names)
    for name, sub in getattr(command, "commands", {}).items():
        _add_names(sub, (*verb, name))


def _completer(names: Callable[[], Iterable[str]]) -> Callable[[Any, Any, str], list[Any]]:
    def complete(_context: Any, _parameter: Any, start: str) -> list[str]:
        """Names, and files beside them: without any, the shell itself completes files."""
        fitting = sorted(name for name in names() if name.startswith(start))
        return [*fitting, *_files(start)] if fitting else []

    return complete


def _files(start: str) -> list[str]:
    """Folders and files of trees, worlds and robots that begin so."""
    folder = Path(start).parent if start and not start.endswith("/") else Path(start or ".")
    try:
        found = sorted(folder.iterdir())
    except OSError:
        return []
    texts = [f"{each}/" if each.is_dir() else str(each) for each in found if _offered(each)]
    return [text for text in texts if text.startswith(start)]


def _offered(path: Path) -> bool:
    return not path.name.startswith(".") and (path.is_dir() or path.suffix in lookup.SUFFIXES)


def _trees() -> Iterable[str]:
    return lookup.bundled()


def _worlds() -> Iterable[str]:
    return [*world_plugins.WORLDS, "none"]


def _robots() -> Iterable[str]:
    return robots.ROBOTS


def _skills() -> Iterable[str]:
    return skills.SKILLS


def _faults() -> Iterable[str]:
    return [kind.name for kind in faults.kinds().values()]


_NAMES: dict[str, Callable[[], Iterable[str]]] = {
    **dict.fromkeys(("tree", "tree_a", "tree_b", "trees", "other"), _trees),
    "world": _worlds,
    "robot": _robots,
    "fault": _faults,
    "skills name": _skills,
    "skills names": _skills,
    "worlds name": _worlds,
    "robots name": _robots,
    "faults name": _faults,
}
"""By the name of a parameter, or by verb and parameter, the names that can stand there."""
