"""`momantu-bt skills stub`: a package with a skill to fill in for each leaf that nothing has."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.cli.shared.notices import notice
from momantu_bt.cli.shared.options import Include
from momantu_bt.errors import ExitCode
from momantu_bt.scaffold.stub import stub
from momantu_bt.tree.files.lookup import find


def stubs(
    tree: Annotated[str, typer.Argument(help="A tree file, in XML or YAML.")],
    into: Annotated[
        Path, typer.Option(help="The folder to make the package's folder in.")
    ] = Path(),
    include: Include = None,
) -> ExitCode:
    """Make a package with a skill for each leaf that a tree uses and nothing here has.

    Ports come from the models in the file, or else from the uses: types from the values that are
    written out, directions from names such as `goal_out`, or from whether a later node reads the
    key. Each skill fails with NOT_WRITTEN until its `run` is filled in. The package installs with
    pip.

    Examples:
      momantu-bt skills stub their_tree.xml
      momantu-bt skills stub their_tree.xml --into ~/robots --include their_trees/
    """
    made = stub(find(tree), into, tuple(include or ()))
    for name, why in made.left_out.items():
        notice(f"left out: {name}: {why}")
    names = ", ".join(made.names)
    typer.echo(f"{made.folder}: {names}; `pip install -e {made.folder}`, then fill in each run()")
    return ExitCode.SUCCESS
