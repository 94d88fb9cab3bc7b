"""A node's one line for people, with the values that its wires carried when it started."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from momantu_bt.tree.model import Literal, Node, PortValue
from momantu_bt.tree.show.printing import text

_SHORT = (str, int, float, bool)
"""Values that fit into a line; of others the wire's name is shown."""


def label(model: Node, values: Mapping[str, Any]) -> str:
    """`dock at bay_a` where the file says `dock: {at: $bay}`."""
    ports: dict[str, PortValue] = {}
    for name, written in model.ports.items():
        value = values.get(name)
        if isinstance(value, float):
            value = float(f"{value:.4g}")
        fits = type(value) in _SHORT and not isinstance(written, Literal)
        ports[name] = Literal(value) if fits else written
    return text(replace(model, ports=ports))
