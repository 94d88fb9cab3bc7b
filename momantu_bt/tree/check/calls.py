"""Checks of skills that call skills: what they call is installed, and `uses` has its actuators."""

from __future__ import annotations

from momantu_bt.plugins import PluginError
from momantu_bt.skill import Skill
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import Node
from momantu_bt.tree.skill_calls import wrong_calls

HINT = "tell its authors"


def check_calls(context: Context) -> None:
    """Report each skill that declares a call which it cannot make, at its first node."""
    found: dict[str, tuple[type[Skill], Node]] = {}
    for tree in context.document.trees.values():
        for node in tree.root.walk():
            signature = context.signature(node)
            if signature is not None and signature.skill is not None and signature.skill.calls:
                found.setdefault(node.type, (signature.skill, node))
    for name, (kind, node) in found.items():
        try:
            wrong = list(wrong_calls(name, kind, context.registry.skills, context.description))
        except PluginError as error:
            wrong = [f"{name} calls a skill that is broken: {error}"]
        for sentence in wrong:
            context.problems.error("broken-plugin", node.place, sentence, HINT)
