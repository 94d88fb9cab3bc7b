"""Words of YAML tree files that are neither nodes nor ports nor modifiers."""

from __future__ import annotations

BTCPP = "btcpp"
"""Key of a script that our spelling cannot say: `skip_if: {btcpp: a && b || c}`."""

SWITCH = "switch"
COMPANIONS = {
    "if": ("then", "else"),
    "while_do": ("do", "else"),
    SWITCH: ("cases", "default"),
}
"""Keys that stand beside a node key and hold its other children."""

PORTS = {"inputs": "in", "outputs": "out", "inouts": "inout"}
HEADER = (*PORTS, "open", "doc")
"""Keys of a tree that stand beside its node."""
