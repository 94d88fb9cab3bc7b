"""`momantu-bt check`: report all mistakes in tree files, without running them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from momantu_bt import collector
from momantu_bt.cli.shared.given import given_goal, given_tree, given_values
from momantu_bt.cli.shared.options import (
    GoalGiven,
    Include,
    Settings,
    Undeclared,
    UndeclaredAre,
    Values,
)
from momantu_bt.errors import ExitCode, InputError
from momantu_bt.faults.tree_file import tree_beside, tree_faults
from momantu_bt.formats.names import counted
from momantu_bt.formats.problems import Problem
from momantu_bt.tree.files.given_text import TreeText
from momantu_bt.tree.files.lookup import is_faults_file
from momantu_bt.tree.files.settings import Given
from momantu_bt.tree.load import Checked, TreeError, TreeNotFound, load
from momantu_bt.tree.problems import report
from momantu_bt.tree.show.problem_pages import explanation
from momantu_bt.tree.show.sarif import sarif


def check(
    trees: Annotated[
        list[str] | None,
        typer.Argument(help="Tree files, names of bundled trees, or - for standard input."),
    ] = None,
    world: Annotated[
        str | None, typer.Option(help="Check against this world; `none` means without one.")
    ] = None,
    robot: Annotated[
        str | None, typer.Option(help="Check against this robot: a name or file.")
    ] = None,
    set_: Settings = None,
    values: Values = None,
    include: Include = None,
    goal: GoalGiven = None,
    undeclared: UndeclaredAre = Undeclared.ERROR,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
    as_sarif: Annotated[
        bool, typer.Option("--sarif", help="Print SARIF 2.1.0, for editors and code reviews.")
    ] = False,
    explain: Annotated[
        str | None, typer.Option(metavar="CODE", help="Explain a problem's code, with examples.")
    ] = None,
) -> ExitCode:
    """Say everything that is wrong with tree files: all errors at once, each with its place.

    Nodes of other programs: models in the file (`TreeNodesModel`) declare them; --undeclared warn
    accepts the others, too; `momantu-bt skills stub` writes plug-ins for them.
    A file of faults, such as my_tree.faults.yaml, is checked against the tree beside it.

    Exit code 0: they can run (there may be warnings); 2: they cannot.

    Examples:
      momantu-bt check trees/bring_object.yaml
      momantu-bt check bring_object --world my_flat.yaml --robot my_robot/
      momantu-bt check --json my_tree.yaml
      momantu-bt check their_tree.xml --set goal=table_b
      momantu-bt check my_tree.yaml --goal "can on table_b beside tag"
      momantu-bt check their_tree.xml --undeclared warn --include their_trees/
      momantu-bt check --explain read-before-write
    """
    collector.skip_the_last()
    if explain is not None:
        typer.echo(explanation(explain).rstrip())
        return ExitCode.SUCCESS
    if not trees:
        raise InputError("name at least one tree file; see momantu-bt check --help")
    if as_json and as_sarif:
        raise InputError("choose one of --json and --sarif")
    given = given_values(set_ or [], values)
    tolerant = undeclared is Undeclared.WARN
    how = _How(world, robot, given, tuple(include or ()), tolerant, given_goal(goal))
    findings = [_checked(tree, how, quiet=as_json or as_sarif) for tree in trees]
    fine = all(finding.ok for finding in findings)
    if as_json:
        _print_json({"ok": fine, "trees": [finding.as_dict() for finding in findings]})
    if as_sarif:
        unread = [finding.unread for finding in findings if finding.unread is not None]
        _print_json(sarif([p for finding in findings for p in finding.problems], unread))
    return ExitCode.SUCCESS if fine else ExitCode.WRONG_INPUT


@dataclass(frozen=True, slots=True)
class _FileChecked:
    """The result for one file. unread: why it could not be opened."""

    tree: str
    ok: bool
    problems: Sequence[Problem] = ()
    unread: str | None = None

    def as_dict(self) -> dict[str, Any]:
        message = {} if self.unread is None else {"message": self.unread}
        problems = [
            {**problem.as_dict(), "help": f"momantu-bt check --explain {problem.code}"}
            for problem in self.problems
        ]
        return {"tree": self.tree, "ok": self.ok, **message, "problems": problems}


@dataclass(frozen=True, slots=True)
class _How:
    """What trees are checked against; see `load`."""

    world: str | None
    robot: str | None
    values: Given
    include: tuple[Path, ...]
    tolerant: bool
    goal: Any

    def load(self, tree: str | TreeText) -> Checked:
        """Read and check a tree; raises as `load` does."""
        return load(
            tree,
            world=self.world,
            robot=self.robot,
            values=self.values,
            include=self.include,
            goal=self.goal,
            tolerant=self.tolerant,
            library=self.tolerant,
        )


def _checked(tree: str, how: _How, *, quiet: bool) -> _FileChecked:
    """Check one file, and unless quiet print the findings."""
    try:
        if is_faults_file(Path(tree)):
            return _checked_faults(Path(tree), how, quiet=quiet)
        checked = how.load(given_tree(tree))
    except (TreeNotFound, TreeError) as error:
        if not quiet:
            typer.echo(error.printed(), err=True)
        if isinstance(error, TreeError):
            return _FileChecked(tree, False, error.problems)
        return _FileChecked(tree, False, unread=str(error))
    if not quiet:
        if checked.problems:
            typer.echo(report(checked.problems, checked.document.source), err=True)
        typer.echo(_fine(tree, checked))
    return _FileChecked(tree, True, checked.problems)


def _checked_faults(file: Path, how: _How, *, quiet: bool) -> _FileChecked:
    """Check a file of faults against the tree beside it."""
    found = tree_faults(how.load(str(tree_beside(file))).document)
    if not quiet:
        size = f"{counted(len(found.begins), 'phase')} and {counted(len(found.rows), 'row')}"
        typer.echo(f"{file}: no errors in {size}")
    return _FileChecked(str(file), True)


def _print_json(value: Any) -> None:
    typer.echo(json.dumps(value, indent=2, ensure_ascii=False))


def _fine(tree: str, checked: Checked) -> str:
    trees = checked.document.trees
    nodes = sum(1 for each in trees.values() for _ in each.root.walk())
    size = f"{counted(len(trees), 'tree')} with {counted(nodes, 'node')}"
    return f"{tree}: no errors in {size}"
