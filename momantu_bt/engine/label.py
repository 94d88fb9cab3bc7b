"""The text of a node in one line, with the values of its inputs at its start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from momantu_bt.tree.model import Literal, Node, PortValue
from momantu_bt.tree.show.printing import text

_SHORT = (str, int, float, bool)
"""Types of values that fit into a line; for others the key is shown."""


def label(model: Node, values: Mapping[str, Any]) -> str:
    """A node's text with values for keys: `dock at bay_a` for `dock: {at: $bay}`."""
    ports: dict[str, PortValue] = {}
    for name, written in model.ports.items():
        value = values.get(name)
        if isinstance(value, float):
            value = float(f"{value:.4g}")
        fits = type(value) in _SHORT and not isinstance(written, Literal)
        ports[name] = Literal(value) if fits else written
    return text(replace(model, ports=ports))
