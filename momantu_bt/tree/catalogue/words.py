"""Words of the language that do not belong to a node: subtrees, conditions, keys beside a node."""

from __future__ import annotations

from collections.abc import Mapping

SUBTREE = "SubTree"
"""Canonical type of a node that runs another tree of the document; `Node.target` names it."""

EXPLICIT = ("Action", "Condition", "Control", "Decorator")
"""Tags in XML whose attribute ID is the node's type, and the kinds of nodes in a palette."""

AUTOREMAP = "_autoremap"
"""Port of a SubTree: whether all other keys inside are the outside keys of the same name."""

FORCED: Mapping[str, str] = {"success": "ForceSuccess", "failure": "ForceFailure"}
"""The decorator for each value of the modifier `force:`."""

PRE_CONDITIONS = ("fail_if", "succeed_if", "skip_if", "while")
"""Conditions that are evaluated before a node's tick, in this order (BehaviorTree.CPP's)."""

POST_SCRIPTS = ("on_success", "on_failure", "on_halt", "after")
"""Scripts that run when a node succeeds, fails or is halted; `after` runs on success or failure."""

CONDITIONS = (*PRE_CONDITIONS, *POST_SCRIPTS)
"""Keys of `Node.conditions`."""

XML_CONDITIONS: Mapping[str, str] = {
    "fail_if": "_failureIf",
    "succeed_if": "_successIf",
    "skip_if": "_skipIf",
    "while": "_while",
    "on_success": "_onSuccess",
    "on_failure": "_onFailure",
    "on_halt": "_onHalted",
    "after": "_post",
}
"""BehaviorTree.CPP's attributes for the conditions."""

NODE_KEYS = ("name", "note", "disabled", "attributes", "xml")
"""Modifiers that are neither decorators nor conditions. The last two keep what only XML says."""

WORDS_OF_TREES = ("again", "any", "child", "children", "try", "catch", "then", "else", "do")
"""Words that can be in the place of a node's name in YAML but are not nodes."""
