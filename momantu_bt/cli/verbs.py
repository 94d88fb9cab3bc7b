"""The verbs of the command line: built-in ones, and those of other packages."""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any, NamedTuple

import typer

from momantu_bt.plugins import Group


class Verb(NamedTuple):
    """A built-in verb.

    module: has a function or a typer app of the verb's name. summary: one line of help.
    """

    module: str
    summary: str


VERBS = {
    "run": Verb("momantu_bt.cli.run.run", "Run a tree."),
    "teleop": Verb("momantu_bt.cli.teleop.teleop", "Drive a robot with the keyboard."),
    "bench": Verb(
        "momantu_bt.cli.bench.bench",
        "Run a tree many times and say how often it works, and why not.",
    ),
    "compare": Verb(
        "momantu_bt.cli.bench.compare",
        "Run two trees on the same seeds and say which works more often.",
    ),
    "replay": Verb(
        "momantu_bt.cli.replay.replay", "Go through a recorded run, or tick its tree again."
    ),
    "diff": Verb("momantu_bt.cli.replay.diff", "Say what two recorded runs differ in."),
    "check": Verb("momantu_bt.cli.trees.check", "Say everything that is wrong with tree files."),
    "convert": Verb(
        "momantu_bt.cli.trees.convert",
        "Write a tree in the other spelling, YAML or BehaviorTree.CPP's XML.",
    ),
    "show": Verb(
        "momantu_bt.cli.trees.show",
        "Print a tree in plain words or as a picture, or the difference of two.",
    ),
    "skills": Verb(
        "momantu_bt.cli.skills.skills", "List skills, or show one with its ports and failure codes."
    ),
    "services": Verb(
        "momantu_bt.cli.services.services", "List services, or show one with the keys it publishes."
    ),
    "worlds": Verb(
        "momantu_bt.cli.worlds", "List worlds, or show one with its places and surfaces."
    ),
    "robots": Verb(
        "momantu_bt.cli.robots.robots",
        "List robots, or show one with its actuators and named poses.",
    ),
    "calibrate": Verb(
        "momantu_bt.cli.calibrate",
        "Estimate a camera's lens or mounting, or a whole robot, from recorded data.",
    ),
    "perception": Verb(
        "momantu_bt.cli.perception",
        "Render labelled pictures, train the learned detector, measure detectors.",
    ),
    "faults": Verb(
        "momantu_bt.cli.faults", "List what can be broken on purpose, or show one fault."
    ),
    "completion": Verb(
        "momantu_bt.cli.completion", "Let the shell complete verbs, options and names."
    ),
    "doctor": Verb("momantu_bt.cli.doctor", "Say what this machine lacks, and the cure."),
}
"""The built-in verbs, by name."""


_WORD = re.compile(r"[a-z][a-z0-9_-]*")


def built_in(verb: str) -> Any:
    """The function or typer app of a built-in verb, whose module is imported now."""
    return getattr(import_module(VERBS[verb].module), verb)


def _objection(name: str, plugin: Any) -> str | None:
    if not callable(plugin):
        return f"{plugin!r} is neither a function nor a typer app"
    if not all(_WORD.fullmatch(word) for word in name.split(" ")) or name.count(" ") > 1:
        return f"{name!r} is not a verb; write a verb, or a verb, one space and a sub-verb"
    verb, blank, _ = name.partition(" ")
    if blank and not _takes_subverbs(verb):
        return f"the verb {verb!r} takes no sub-verbs"
    return None


def _takes_subverbs(verb: str) -> bool:
    """Whether a verb is a typer app."""
    if verb in VERBS:
        return isinstance(built_in(verb), typer.Typer)
    return verb in COMMANDS and isinstance(COMMANDS.load(verb), typer.Typer)


COMMANDS: Group[Any] = Group("momantu_bt.commands", "verb", _objection)
"""Functions or typer apps; names of two words, such as `worlds import`, are sub-verbs."""
