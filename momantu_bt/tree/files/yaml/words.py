"""Words of YAML tree files that are neither nodes nor ports nor modifiers."""

from __future__ import annotations

from collections.abc import Mapping

BTCPP = "btcpp"
"""Key of a script that our spelling cannot say: `skip_if: {btcpp: a && b || c}`."""

SWITCH = "switch"
COMPANIONS = {
    "if": ("then", "else"),
    "while_do": ("do", "else"),
    SWITCH: ("cases", "default"),
}
"""Keys that stand beside a node key and hold its other children."""

NODE, RUNS = "node", "subtree"
NAMED: Mapping[str, tuple[str, ...]] = {NODE: ("ports", "children"), RUNS: ("ports", "children")}
"""Keys whose value names a node of any kind, or a tree of any file; the keys beside them."""

PORTS = {"inputs": "in", "outputs": "out", "inouts": "inout"}
HEADER = (*PORTS, "open", "doc", "metadata", "tree", "nodes")
"""Keys of a tree that stand beside its node."""
