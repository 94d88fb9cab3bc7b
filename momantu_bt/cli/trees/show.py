"""`momantu-bt show`: a tree in plain words or as a picture, or the difference of two."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt import collector
from momantu_bt.cli.shared.given import given_tree, given_values
from momantu_bt.cli.shared.options import TREE, Include, Settings, Values
from momantu_bt.drawing.boxes import pictures
from momantu_bt.drawing.difference import difference
from momantu_bt.drawing.dot import dot
from momantu_bt.drawing.mermaid import mermaid
from momantu_bt.drawing.svg import svg
from momantu_bt.drawing.wires import Wire, wire_lines, wires
from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import write_whole
from momantu_bt.tree.catalogue.wording import value_text
from momantu_bt.tree.check.named_world import world_of
from momantu_bt.tree.files.settings import Given
from momantu_bt.tree.load import load
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.show.printing import lines, main_first

INDENT = "  "
DRAWINGS = {"svg": svg, "dot": dot, "mermaid": mermaid}
"""Ways to draw a tree, by the option that asks for each."""


def show(
    tree: Annotated[str, typer.Argument(help=TREE)],
    other: Annotated[
        str | None, typer.Argument(help="Another one: print the changes from the first to it.")
    ] = None,
    world: Annotated[str | None, typer.Option(help="Check against this world.")] = None,
    set_: Settings = None,
    values: Values = None,
    include: Include = None,
    as_svg: Annotated[bool, typer.Option("--svg", help="Draw an SVG picture.")] = False,
    as_dot: Annotated[bool, typer.Option("--dot", help="Print it for Graphviz.")] = False,
    as_mermaid: Annotated[bool, typer.Option("--mermaid", help="Print a Mermaid chart.")] = False,
    with_wires: Annotated[
        bool, typer.Option("--wires/--no-wires", help="Whether to show wires.")
    ] = True,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Write to this file instead.")
    ] = None,
) -> ExitCode:
    """Print a tree in plain words, with what is wrapped around each node, and its wires.

    The tree is checked first; exit code 2: it has errors, and they are shown instead. Nodes and
    trees that stand elsewhere are no errors here.
    With two trees, what was added (+), removed (-) and changed (~) on the way from the first to
    the second, whichever spelling each is written in; exit code 0: they say the same; 1: they
    differ.

    Examples:
      momantu-bt show bring_object
      momantu-bt show bring_object --svg -o bring_object.svg
      momantu-bt show trees/bring_object.yaml my_tree.yaml
    """
    collector.skip_the_last()
    kinds = [name for name, on in (("svg", as_svg), ("dot", as_dot), ("mermaid", as_mermaid)) if on]
    if len(kinds) > 1:
        raise typer.BadParameter(f"choose one of --{' and --'.join(kinds)}")
    if other is not None and kinds:
        raise typer.BadParameter(f"the difference of two trees is text; leave --{kinds[0]} out")
    registry = Registry.installed()
    how = _How(registry, world, given_values(set_ or [], values), tuple(include or ()))
    document = how.read(tree)
    code = ExitCode.SUCCESS
    if kinds and not document.trees:
        raise InputError(f"{tree} has models alone, and no tree to draw")
    if other is not None:
        found = difference(document, how.read(other))
        text = "".join(f"{line.mark} {INDENT * line.depth}{line.text}\n" for line in found)
        code = ExitCode.FAILURE if found else ExitCode.SUCCESS
    elif kinds:
        text = _picture(kinds[0], document, registry, with_wires)
    else:
        found_wires = wires(document, registry) if with_wires else []
        text = "".join(f"{line}\n" for line in _words(document, found_wires, world))
    _write(text, output)
    return code


@dataclass(frozen=True, slots=True)
class _How:
    """What trees are read with; see `load`."""

    registry: Registry
    world: str | None
    values: Given
    include: tuple[Path, ...]

    def read(self, tree: str) -> Document:
        """The tree, checked; raises as `load` does."""
        checked = load(
            given_tree(tree),
            self.registry,
            world=self.world,
            values=self.values,
            include=self.include,
            tolerant=True,
            library=True,
        )
        return checked.document


def _picture(kind: str, document: Document, registry: Registry, with_wires: bool) -> str:
    return DRAWINGS[kind](pictures(document, registry), wires=with_wires)


def _words(document: Document, found: list[Wire], world: str | None) -> Iterator[str]:
    if not document.trees:
        count = len(document.models)
        yield f"{document.file}: {count} model{'s' if count > 1 else ''}, no tree"
        return
    yield f"{document.file}: {document.main}" + _where(world_of(document, world))
    for name, value in document.values.items():
        yield f"{INDENT}{name} = {value_text(value)}"
    names = [tree.name for tree in main_first(document)]
    printed = list(lines(document))
    starts = [at for at, line in enumerate(printed) if line.depth == 0]
    for name, start, end in zip(names, starts, [*starts[1:], len(printed)], strict=True):
        yield ""
        yield from (INDENT * line.depth + line.text for line in printed[start:end])
        its = list(wire_lines(document, found, name))
        if its:
            file = document.trees[name].place.file
            where = "the file" if file == document.file else Path(file).name
            yield f"{INDENT}wires, with lines of {where}"
            yield from (INDENT * 2 + line for line in its)


def _where(world: str | None) -> str:
    return "" if world is None else f" in {world}"


def _write(text: str, output: Path | None) -> None:
    if output is None:
        typer.echo(text, nl=False)
        return
    write_whole(output, text)
