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
    """A list of steps without a name."""
    NAMED_STEPS = "named steps"
    """A list of steps with a name. If it is the whole tree, it is drawn like one without."""
    AROUND = "around"
    """A decorator; it is drawn together with its child."""
    RECOVERY = "recovery"
    """It recovers from failures; displays say how."""
    PLAIN = "plain"
    """Every other node."""
