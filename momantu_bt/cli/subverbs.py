"""Sub-verbs of other packages: `worlds import` is an entry point of that name.

Only the requested sub-verb is imported. The others are listed by name with a line of help from
their source, so that a heavy or broken module does not disturb the rest.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from copy import copy
from importlib.metadata import EntryPoint
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import typer

from momantu_bt.cli.shared.help import help_of
from momantu_bt.cli.verbs import COMMANDS


def with_subverbs(verb: Any, name: str, given: Sequence[str]) -> Any:
    """The verb; if it is a group of commands, a copy with the sub-verbs of other packages.

    If the verb has a command of the same name itself, that command is used.

    Args:
        verb: a function or a typer app.
        name: the verb's name.
        given: the words that follow the verb on the command line.

    Raises:
        PluginError: the requested sub-verb is broken.
    """
    if not isinstance(verb, typer.Typer):
        return verb
    app = copy(verb)
    app.registered_commands = list(verb.registered_commands)
    app.registered_groups = list(verb.registered_groups)
    own = _names(verb)
    asked = next((word for word in given if not word.startswith("-")), None)
    for full_name, entry in COMMANDS.installed().items():
        first, blank, sub = full_name.partition(" ")
        if first != name or not blank or sub in own:
            continue
        if sub == asked:
            add_command(app, sub, COMMANDS.load(full_name))
        else:
            app.command(sub, help=summary(entry))(_never)
    return app


def add_command(app: typer.Typer, name: str, command: Any) -> None:
    """Add a command, a function or a typer app, under a name."""
    if isinstance(command, typer.Typer):
        own = command.registered_callback
        if own is None or own.callback is None or isinstance(own.help, str):
            app.add_typer(command, name=name)
        else:
            app.add_typer(command, name=name, help=help_of(own.callback))
    else:
        app.command(name, help=help_of(command))(command)


def summary(entry: EntryPoint) -> str:
    """The first line of a command's docstring, or else the package it comes from.

    The command's module is read, not run.
    """
    package = entry.dist.name if entry.dist is not None else "a plug-in"
    return _first_line(entry) or f"From {package}."


def _names(app: typer.Typer) -> set[str]:
    """The app's own sub-verbs."""
    commands = [
        command.name or command.callback.__name__
        for command in app.registered_commands
        if command.callback is not None
    ]
    return {*commands, *(str(group.name) for group in app.registered_groups)}


def _first_line(entry: EntryPoint) -> str:
    try:
        source = _source(entry.module)
        tree = ast.parse(source.read_bytes()) if source is not None else None
    except (ImportError, OSError, SyntaxError, ValueError):
        return ""
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    named = [
        n
        for n in (tree.body if tree else [])
        if isinstance(n, kinds) and (n.name == entry.attr or _calls_back(n, entry.attr))
    ]
    doc = ast.get_docstring(named[-1]) if named else None
    return (doc or "").partition("\n")[0]


def _calls_back(node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef, app: str) -> bool:
    """Whether a function is decorated with `@app.callback()`: it is what the group itself does."""
    calls = [each.func for each in node.decorator_list if isinstance(each, ast.Call)]
    return any(ast.unparse(each) == f"{app}.callback" for each in calls)


def _source(module: str) -> Path | None:
    """A module's file, found beneath its first package; nothing is imported."""
    first, *inner = module.split(".")
    spec = find_spec(first)
    if spec is None:
        return None
    if not inner:
        return Path(spec.origin) if spec.has_location and spec.origin else None
    for folder in spec.submodule_search_locations or ():
        path = Path(folder, *inner)
        for file in (path.with_suffix(".py"), path / "__init__.py"):
            if file.is_file():
                return file
    return None


def _never() -> None:
    """A placeholder for a sub-verb that was not given."""
