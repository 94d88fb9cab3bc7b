"""`momantu-bt check`: everything that is wrong with tree files, without running them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import typer

from momantu_bt.tree.load import Checked, TreeError, TreeNotFound, load
from momantu_bt.tree.problems import Problem, Severity, show

EXIT_WRONG_INPUT = 2
MOST_SHOWN = 50
"""Problems printed in full; a terminal holds no more, and the rest often follow from them."""


def check(
    trees: Annotated[list[str], typer.Argument(help="Tree files, or names of bundled trees.")],
    world: Annotated[
        str | None, typer.Option(help="Check against this world; `none` is without one.")
    ] = None,
    robot: Annotated[str | None, typer.Option(help="Check against this robot.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> int:
    """Say everything that is wrong with tree files: all errors at once, each with its place.

    Exit code 0: they can run (there may be warnings); 2: they cannot.

    Examples:
      momantu-bt check trees/bring_object.yaml
      momantu-bt check bring_object --world four_rooms --robot fetch
      momantu-bt check --json my_tree.yaml
    """
    reports: list[dict[str, Any]] = []
    fine = True
    for tree in trees:
        try:
            checked = load(tree, world=world, robot=robot)
        except TreeNotFound as error:
            fine = False
            reports.append({"tree": tree, "ok": False, "message": str(error), "problems": []})
            if not as_json:
                typer.echo(f"momantu-bt: {error}", err=True)
        except TreeError as error:
            fine = False
            reports.append(_as_json(tree, False, error.problems))
            if not as_json:
                report(error.problems, error.source)
        else:
            reports.append(_as_json(tree, True, checked.notes))
            if not as_json:
                report(checked.notes, checked.document.source)
                typer.echo(_fine(tree, checked))
    if as_json:
        typer.echo(json.dumps({"ok": fine, "trees": reports}, indent=2, ensure_ascii=False))
    return 0 if fine else EXIT_WRONG_INPUT


def report(problems: Sequence[Problem], source: Mapping[str, str]) -> None:
    """Print problems to standard error, each with its line and a caret, and count them."""
    if not problems:
        return
    for problem in problems[:MOST_SHOWN]:
        typer.echo(show(problem, source), err=True)
    if len(problems) > MOST_SHOWN:
        typer.echo(f"… and {len(problems) - MOST_SHOWN} more (--json has them all)", err=True)
    counts = [
        f"{count} {severity.name.lower()}{'s' if count > 1 else ''}"
        for severity in Severity
        if (count := sum(problem.severity is severity for problem in problems))
    ]
    typer.echo(", ".join(counts), err=True)


def _as_json(tree: str, ok: bool, problems: Sequence[Problem]) -> dict[str, Any]:
    return {"tree": tree, "ok": ok, "problems": [problem.as_dict() for problem in problems]}


def _fine(tree: str, checked: Checked) -> str:
    trees = checked.document.trees
    nodes = sum(1 for each in trees.values() for _ in each.root.walk())
    return f"{tree}: no errors in {len(trees)} trees with {nodes} nodes"
