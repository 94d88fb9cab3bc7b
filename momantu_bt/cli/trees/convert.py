"""`momantu-bt convert`: a tree file in its other spelling."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.cli.shared.given import given_tree
from momantu_bt.cli.shared.notices import notice
from momantu_bt.cli.shared.options import TREE
from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import OutputError, check_writable, write_whole
from momantu_bt.tree.convert import (
    CannotWrite,
    Spelling,
    document_spelling,
    read_format_3,
    read_right,
    spelling_of,
    write,
)
from momantu_bt.tree.files.given_text import TreeText
from momantu_bt.tree.files.lookup import find
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry


def convert(
    tree: Annotated[str, typer.Argument(help=TREE)],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Write to this file, not to the terminal.")
    ] = None,
    to: Annotated[
        Spelling | None,
        typer.Option(help="yaml or xml. Default: OUTPUT's ending, or the other one."),
    ] = None,
    from_format: Annotated[
        str | None,
        typer.Option("--from", metavar="3", help="The file is of BehaviorTree.CPP 3, not 4."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite OUTPUT.")] = False,
) -> ExitCode:
    """Write a tree file in the other spelling, YAML or BehaviorTree.CPP's XML. Nothing is lost.

    Comments come along. Nodes need not be installed, but a file that is wrong in form is refused.
    Files that it includes stay as they are. Exit code 2: nothing was written.

    Examples:
      momantu-bt convert trees/bring_object.yaml
      momantu-bt convert from_groot.xml -o trees/mine.yaml
      momantu-bt convert mine.yaml --to yaml -o mine.yaml --force
      momantu-bt convert --from 3 old.xml -o new.xml
    """
    if from_format not in (None, "3"):
        raise InputError(f"--from {from_format}: 3 is known, for files of BehaviorTree.CPP 3")
    if output is not None:
        _check(output, force)
    registry = Registry.installed()
    try:
        document = _read(tree, registry, old=from_format is not None)
        spelling = to or _wanted(document, output)
        if output is not None:
            _move_includes(document, output)
        text = write(document, spelling, registry)
    except CannotWrite as error:
        raise InputError(f"{error.place or tree}: {error}") from None
    if output is None:
        typer.echo(text, nl=False)
    else:
        write_whole(output, text)
        typer.echo(f"wrote {output}")
    return ExitCode.SUCCESS


def _read(tree: str, registry: Registry, *, old: bool) -> Document:
    """Read a file, and say what the result does not have as the file meant it."""
    source = given_tree(tree)
    found = source if isinstance(source, TreeText) else find(source)
    if old:
        document, remarks = read_format_3(found, registry)
        for place, message in remarks:
            notice(f"{place}: {message}")
        return document
    document, unread = read_right(found, registry)
    for problem in unread:
        notice(f"{problem.place}: {problem.message}; its trees are taken for nodes")
    return document


def _check(output: Path, force: bool) -> None:
    """Before anything is read."""
    check_writable(output)
    if output.exists() and not force:
        raise OutputError(f"{output} is there already; --force overwrites it")


def _wanted(document: Document, output: Path | None) -> Spelling:
    if output is None:
        return document_spelling(document).other
    found = spelling_of(output)
    if found is None:
        raise OutputError(f"{output} ends with neither .yaml nor .xml; say --to yaml or --to xml")
    return found


def _move_includes(document: Document, output: Path) -> None:
    """Paths of included files are relative to the file that includes them."""
    before, after = Path(document.file).resolve().parent, output.resolve().parent
    if before != after:
        document.includes = tuple(
            replace(each, path=Path(os.path.relpath(before / each.path, after)).as_posix())
            for each in document.includes
        )
