"""`momantu-bt show`: a tree in plain words."""

from __future__ import annotations

from typing import Annotated

import typer

from momantu_bt.tree.check import NO_WORLD
from momantu_bt.tree.load import load
from momantu_bt.tree.printing import lines, value_text

INDENT = "  "


def show(
    tree: Annotated[str, typer.Argument(help="A tree file, or the name of a bundled tree.")],
    world: Annotated[str | None, typer.Option(help="Check against this world.")] = None,
) -> None:
    """Print a tree in plain words, with what is wrapped around each node.

    The tree is checked first; exit code 2: it has errors, and they are shown instead.

    Examples:
      momantu-bt show bring_object
      momantu-bt show trees/bring_object.yaml
    """
    document = load(tree, world=world).document
    typer.echo(f"{document.file}: {document.main}" + _where(world or document.world))
    for name, value in document.values.items():
        typer.echo(f"{INDENT}{name} = {value_text(value)}")
    for line in lines(document):
        if line.depth == 0:
            typer.echo()
        typer.echo(INDENT * line.depth + line.text)


def _where(world: str | None) -> str:
    return "" if world in (None, NO_WORLD) else f" in {world}"
