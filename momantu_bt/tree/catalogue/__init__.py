"""Every built-in node: its canonical type, its spelling in YAML, its ports and its children.

Canonical types and their meaning are BehaviorTree.CPP 4's and Nav2's where they have the node; the
rest is ours. The engine's classes are keyed by the canonical type, the readers by the spelling.
"""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.tree.catalogue.controls import CONTROLS
from momantu_bt.tree.catalogue.decorators import DECORATORS
from momantu_bt.tree.catalogue.leaves import LEAVES
from momantu_bt.tree.catalogue.nav2 import NAV2
from momantu_bt.tree.catalogue.spec import Kind, NodeSpec

__all__ = [
    "AUTOREMAP",
    "BUILT_IN",
    "CONDITIONS",
    "FORCED",
    "MODIFIERS",
    "NAV2_NODES",
    "NODE_KEYS",
    "OWN_NODES",
    "POST_SCRIPTS",
    "PRE_CONDITIONS",
    "SPELLED",
    "SUBTREE",
    "SWITCHES",
    "XML_CONDITIONS",
    "Kind",
    "NodeSpec",
]

SUBTREE = "SubTree"
"""Canonical type of a node that runs another tree of the document; `Node.target` names it."""

AUTOREMAP = "_autoremap"
"""Port of a SubTree: whether every key inside that no wire names is the same key outside."""

BUILT_IN: Mapping[str, NodeSpec] = {
    spec.type: spec for spec in (*CONTROLS, *DECORATORS, *LEAVES, *NAV2)
}
"""Built-in nodes by canonical type."""

SWITCHES: Mapping[int, NodeSpec] = {spec.switch: spec for spec in CONTROLS if spec.switch}
"""The switches by their number of cases; in YAML all are `switch`."""

SPELLED: Mapping[str, NodeSpec] = {name: spec for spec in BUILT_IN.values() for name in spec.yaml}
"""Built-in nodes by YAML spelling."""

FORCED: Mapping[str, str] = {"success": "ForceSuccess", "failure": "ForceFailure"}
"""What the modifier `force:` makes of its value."""

PRE_CONDITIONS = ("fail_if", "succeed_if", "skip_if", "while")
"""Conditions asked before a node's tick, in this order (BehaviorTree.CPP's)."""

POST_SCRIPTS = ("on_success", "on_failure", "on_halt", "after")
"""Scripts run when a node ends: so, or (`after`) with success or failure."""

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

OWN_NODES = frozenset({"Recover", "Handle", "ForEach", "Fail", "Ask", "Confirm", "ElseFail"})
"""Nodes that BehaviorTree.CPP and Nav2 do not have; in XML they stand in our namespace."""

NAV2_NODES = frozenset(spec.type for spec in NAV2)
"""Nodes of Nav2's plug-ins, which BehaviorTree.CPP does not have of itself."""

NODE_KEYS = ("name", "note", "disabled")
"""Modifiers that are neither decorators nor conditions."""

MODIFIERS: Mapping[str, str] = {
    **dict.fromkeys(NODE_KEYS, "key"),
    **dict.fromkeys(CONDITIONS, "condition"),
    **{spec.yaml[0]: "decorator" for spec in BUILT_IN.values() if spec.modifier},
    "force": "decorator",
}
"""Reserved modifier names of YAML, and what each one is."""
