"""The catalogue of nodes: names, ports, children, checks and wording.

Canonical types and their meaning are BehaviorTree.CPP 4's and Nav2's where they have the node; the
rest is ours. Nodes themselves are in `momantu_bt/nodes` and in plug-ins.
"""

from __future__ import annotations

from momantu_bt.tree.catalogue.nodes import (
    MODIFIERS,
    NODE_CLASSES,
    NODES,
    SPELLED,
    SWITCHES,
    is_ours,
    of_dialect,
    plugged_in,
)
from momantu_bt.tree.catalogue.spec import Dialect, Kind, NodeSpec
from momantu_bt.tree.catalogue.words import (
    AUTOREMAP,
    CONDITIONS,
    EXPLICIT,
    FORCED,
    NODE_KEYS,
    POST_SCRIPTS,
    PRE_CONDITIONS,
    SUBTREE,
    XML_CONDITIONS,
)

__all__ = [
    "AUTOREMAP",
    "CONDITIONS",
    "EXPLICIT",
    "FORCED",
    "MODIFIERS",
    "NODES",
    "NODE_CLASSES",
    "NODE_KEYS",
    "POST_SCRIPTS",
    "PRE_CONDITIONS",
    "SPELLED",
    "SUBTREE",
    "SWITCHES",
    "XML_CONDITIONS",
    "Dialect",
    "Kind",
    "NodeSpec",
    "is_ours",
    "of_dialect",
    "plugged_in",
]
