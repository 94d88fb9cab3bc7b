"""Options that several verbs share."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

Seeds: TypeAlias = Annotated[str, typer.Option(help="0:500, 3,5,7 or 0:10,20:30.")]
Jobs: TypeAlias = Annotated[
    int | None, typer.Option(min=1, help="Episodes at a time. Default: one per core.")
]
Robot: TypeAlias = Annotated[
    str | None, typer.Option(help="A robot's name or file. Default: the world's own.")
]
MapTold: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--map",
        metavar="DIR",
        help="The floor plan that the robot is told: a folder of `momantu-bt map`, a map_server "
        "YAML file, or none. Default: the world's own.",
    ),
]
NamesTold: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--names",
        metavar="FILE",
        help="Names of places and surfaces that the robot is told: a site.yaml, or a map's folder.",
    ),
]
Seed: TypeAlias = Annotated[
    int, typer.Option(min=0, help="Varies the episode. The same seed gives the same run.")
]
View: TypeAlias = Annotated[bool, typer.Option("--view", help="Serve the scene to a browser.")]
ViewPort: TypeAlias = Annotated[int, typer.Option(help="The port of --view.")]
RecordFolder: TypeAlias = Annotated[
    Path | None, typer.Option(help="A new folder for the report and a log of the whole run.")
]
ReportTo: TypeAlias = Annotated[
    Path | None, typer.Option(help="Write the report to this JSON file.")
]
Include: TypeAlias = Annotated[
    list[Path] | None,
    typer.Option(help="A file, or a folder of files, with trees that the tree runs."),
]
Settings: TypeAlias = Annotated[
    list[str] | None, typer.Option("--set", help="key=value: a value of the tree's blackboard.")
]
Values: TypeAlias = Annotated[Path | None, typer.Option(help="A YAML file of values.")]
MaxTime: TypeAlias = Annotated[
    float, typer.Option(min=0.05, help="Simulated seconds after which an episode fails.")
]
Judged: TypeAlias = Annotated[
    bool, typer.Option("--referee/--no-referee", help="Whether the referee judges the episodes.")
]
GoalGiven: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--goal",
        metavar="GOAL",
        help="What the referee demands: world, none, 'can on table_b beside tag', or FILE.yaml.",
    ),
]


class Undeclared(StrEnum):
    """What nodes are that no plug-in offers and no model declares."""

    ERROR = "error"
    WARN = "warn"


UndeclaredAre: TypeAlias = Annotated[
    Undeclared, typer.Option(help="What nodes, trees and keys that stand elsewhere are.")
]
EpisodeLimit: TypeAlias = Annotated[
    float, typer.Option(min=1.0, help="Seconds of wall time after which an episode is killed.")
]
Runner: TypeAlias = Annotated[
    str, typer.Option(help="What runs the episodes: local, or ray (several machines).")
]
RayAddress: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="HOST:PORT", help="The Ray cluster, or auto. Default: one on this machine."
    ),
]
Kept: TypeAlias = Annotated[
    str, typer.Option(help="Which episodes leave a record: failures, all or none.")
]

TREE = "A tree file, the name of a bundled tree, or - for standard input."
"""Help of the argument that is a tree."""
VIEW_PORT = 8080
"""The default port of `--view`."""
OUT = Path("runs/bench")
"""The default folder for results, with a folder for each tree."""
RECORD = ("failures", "all", "none")
"""Values of `--record`."""
