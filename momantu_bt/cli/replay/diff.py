"""`momantu-bt diff`: the differences between two recorded runs."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt.cli.replay import records
    from momantu_bt.replay import compare

if TYPE_CHECKING:
    from momantu_bt.replay.compare import Comparison


MOST_LINES = 20
"""Lines shown of one text's diff, and of the nodes whose counts differ; `--json` has them all."""
_WIDEST = 160


def diff(
    left: Annotated[Path, typer.Argument(help="The folder of a record.")],
    right: Annotated[Path, typer.Argument(help="The folder of another one.")],
    json_: Annotated[bool, typer.Option("--json", help="Print the differences as JSON.")] = False,
) -> ExitCode:
    """Say where two recorded runs part, and how they differ as a whole.

    Wall times, folders and tracebacks do not count. Exit code 0: they are equal; 1: they are
    not; 2: one of them is not a record.

    Examples:
      momantu-bt diff runs/3 runs/4
      momantu-bt diff before after --json
    """
    both = [records.open_record(folder) for folder in (left, right)]
    comparison = compare.compare(*both)
    if json_:
        typer.echo(json.dumps(comparison.as_dict(), indent=2))
    else:
        for line in _lines(comparison):
            typer.echo(line)
    return ExitCode.SUCCESS if comparison.equal else ExitCode.FAILURE


def _lines(found: Comparison) -> Iterator[str]:
    if found.equal:
        yield "the runs are equal: the same in every tick, and the same end"
    first = found.first
    if first is not None:
        where = f" of {first.where}" if first.where else ""
        yield f"first difference: tick {first.tick}, {first.now:.2f} s: {first.kind}{where}"
        yield f"  left:  {first.left}"
        yield f"  right: {first.right}"
    if found.parting is not None:
        yield f"the ways part after: {found.parting.before or 'the start'}"
        yield f"  left:  {found.parting.left}"
        yield f"  right: {found.parting.right}"
    yield from _table("how they ended", found.outcome)
    yield from _table("what they were made with", found.given)
    for name, lines in found.files.items():
        yield f"{name}:"
        yield from (f"  {line}" for line in _some(lines))
    yield from _table("nodes", found.nodes)


def _table(title: str, rows: Sequence[tuple[str, str, str]]) -> Iterator[str]:
    if rows:
        yield f"{title}:"
        yield from _some([f"  {name}: {_cut(left)} | {_cut(right)}" for name, left, right in rows])


def _some(lines: Sequence[str]) -> Sequence[str]:
    left_out = len(lines) - MOST_LINES
    if left_out <= 0:
        return lines
    return [*lines[:MOST_LINES], f"  … and {left_out} lines more; --json has them all"]


def _cut(text: str) -> str:
    return text if len(text) <= _WIDEST else text[: _WIDEST - 1] + "…"
