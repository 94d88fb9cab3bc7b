"""Checks that the robot has what the tree's skills need."""

from __future__ import annotations

from momantu_bt.lacking import lacking, lacks_text
from momantu_bt.plugins import PluginError
from momantu_bt.skill import Skill
from momantu_bt.tree.check.signatures import Context

HINT = "take another robot, or leave the node out"


def check_robot_fit(context: Context) -> None:
    """Report each skill that the robot cannot run, at its first node."""
    if context.description is None:
        return
    seen: set[str] = set()
    for tree in context.document.trees.values():
        for node in tree.root.walk():
            signature = context.signature(node)
            if node.disabled or signature is None or signature.skill is None:
                continue
            lacks = () if node.type in seen else _lacking(context, signature.skill)
            seen.add(node.type)
            if lacks:
                message = lacks_text(node.type, lacks, context.description)
                context.problems.error("robot-lacks", node.place, message, HINT)


def _lacking(context: Context, kind: type[Skill]) -> tuple[str, ...]:
    assert context.description is not None
    try:
        return tuple(lacking(kind, context.registry.services, context.description))
    except PluginError:  # reported where the service is
        return ()
