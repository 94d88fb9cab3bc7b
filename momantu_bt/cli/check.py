"""`momantu-bt check`: everything that is wrong with tree files, without running them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import typer

from momantu_bt.tree.load import Checked, TreeError, TreeNotFound, load
from momantu_bt.tree.problems import Problem, Severity, show, valid_names
from momantu_bt.tree.show.problem_pages import UnknownCode, codes, explanation
from momantu_bt.tree.show.sarif import sarif

EXIT_WRONG_INPUT = 2
MOST_SHOWN = 50
"""Problems printed in full; a terminal holds no more, and the rest often follow from them."""


def check(
    trees: Annotated[
        list[str] | None, typer.Argument(help="Tree files, or names of bundled trees.")
    ] = None,
    world: Annotated[
        str | None, typer.Option(help="Check against this world; `none` is without one.")
    ] = None,
    robot: Annotated[str | None, typer.Option(help="Check against it: a name or file.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
    as_sarif: Annotated[
        bool, typer.Option("--sarif", help="Print SARIF 2.1.0, for editors and code reviews.")
    ] = False,
    explain: Annotated[
        str | None, typer.Option(metavar="CODE", help="Explain a problem's code, with examples.")
    ] = None,
) -> int:
    """Say everything that is wrong with tree files: all errors at once, each with its place.

    Exit code 0: they can run (there may be warnings); 2: they cannot.

    Examples:
      momantu-bt check trees/bring_object.yaml
      momantu-bt check bring_object --world four_rooms --robot fetch
      momantu-bt check --json my_tree.yaml
      momantu-bt check --explain read-before-write
    """
    if explain is not None:
        return _explain(explain)
    if not trees:
        return _refuse("name at least one tree file; see momantu-bt check --help")
    if as_json and as_sarif:
        return _refuse("choose one of --json and --sarif")
    findings = [_checked(tree, world, robot, quiet=as_json or as_sarif) for tree in trees]
    fine = all(finding.ok for finding in findings)
    if as_json:
        _print_json({"ok": fine, "trees": [finding.as_dict() for finding in findings]})
    if as_sarif:
        unread = [finding.unread for finding in findings if finding.unread is not None]
        _print_json(sarif([p for finding in findings for p in finding.problems], unread))
    return 0 if fine else EXIT_WRONG_INPUT


@dataclass(frozen=True, slots=True)
class _Finding:
    """What is known of one file. unread: why it could not be opened."""

    tree: str
    ok: bool
    problems: Sequence[Problem] = ()
    unread: str | None = None

    def as_dict(self) -> dict[str, Any]:
        message = {} if self.unread is None else {"message": self.unread}
        problems = [problem.as_dict() for problem in self.problems]
        return {"tree": self.tree, "ok": self.ok, **message, "problems": problems}


def _checked(tree: str, world: str | None, robot: str | None, *, quiet: bool) -> _Finding:
    """Check one file, and unless quiet say what is found."""
    try:
        checked = load(tree, world=world, robot=robot)
    except TreeNotFound as error:
        if not quiet:
            typer.echo(f"momantu-bt: {error}", err=True)
        return _Finding(tree, False, unread=str(error))
    except TreeError as error:
        if not quiet:
            report(error.problems, error.source)
        return _Finding(tree, False, error.problems)
    if not quiet:
        report(checked.notes, checked.document.source)
        typer.echo(_fine(tree, checked))
    return _Finding(tree, True, checked.notes)


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
    gravest = min(problems, key=lambda problem: problem.severity)
    more = f"momantu-bt check --explain {gravest.code} says more"
    typer.echo(f"{', '.join(counts)}; {more}", err=True)


def _explain(code: str) -> int:
    try:
        typer.echo(explanation(code).rstrip())
    except UnknownCode:
        hint = valid_names(code, codes(), "codes")
        return _refuse(f"no problem has the code {code!r}; {hint}")
    return 0


def _refuse(message: str) -> int:
    typer.echo(f"momantu-bt: {message}", err=True)
    return EXIT_WRONG_INPUT


def _print_json(value: Any) -> None:
    typer.echo(json.dumps(value, indent=2, ensure_ascii=False))


def _fine(tree: str, checked: Checked) -> str:
    trees = checked.document.trees
    nodes = sum(1 for each in trees.values() for _ in each.root.walk())
    return f"{tree}: no errors in {len(trees)} trees with {nodes} nodes"
