"""The role of a node for a person who watches a run."""

from __future__ import annotations

from enum import Enum


class Role(Enum):
    """How a node is drawn and described."""

    ACT = "act"
    """It does something: a skill, a wait, a question."""
    TREE = "tree"
    """It runs another tree."""
    STEPS = "steps"
    """The nameless frame of a list of steps."""
    NAMED_STEPS = "named steps"
    """The same with a name; still a frame where it is all that a tree is."""
    AROUND = "around"
    """It stands around one child, and is drawn with it."""
    RECOVERY = "recovery"
    """What it does about a failure is told."""
    PLAIN = "plain"
    """Every other node."""
