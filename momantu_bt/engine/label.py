"""The text of a node in one line, with the values of its inputs at its start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from momantu_bt.tree.model import Literal, Node, PortValue
from momantu_bt.tree.show.printing import text

_SHORT = (str, int, float, bool)
"""Types of values that fit into a line; for others the key is shown."""


class ShowsValues:
    """A base class beside `TreeNode`: the node's label holds the values of its inputs.

    The text is made when somebody asks for it.
    """

    model: Node
    _values: Mapping[str, Any] = MappingProxyType({})
    _label = ""
    _labelled: Mapping[str, Any] = _values

    @property
    def label(self) -> str:
        """One line of text for displays; after the start it includes the inputs' values."""
        values, before = self._values, self._labelled
        if values is not before:
            if not _same(values, before):
                self._label = label(self.model, values)
            self._labelled = values
        return self._label

    @label.setter
    def label(self, text: str) -> None:
        self._label, self._labelled = text, self._values

    def show_values(self, values: Mapping[str, Any]) -> None:
        """Show these values of the inputs, by port. They must not change any more."""
        self._values = values


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


def _same(values: Mapping[str, Any], before: Mapping[str, Any]) -> bool:
    """Whether these are the same objects by the same names."""
    return values.keys() == before.keys() and all(values[n] is before[n] for n in values)
