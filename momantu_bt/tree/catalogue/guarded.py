"""Functions in the specs of other packages: when one raises, the error names the node."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from momantu_bt.errors import PLUGIN_ERRORS, MomantuError, words_of
from momantu_bt.plugins import PluginError
from momantu_bt.tree.catalogue.spec import NodeSpec

P = ParamSpec("P")
R = TypeVar("R")

FUNCTIONS = ("flow", "codes", "objection", "port_words", "around", "roles")
"""The arguments of a spec that are functions."""


def guarded(spec: NodeSpec) -> NodeSpec:
    """The spec of a plug-in's node, with functions that turn any exception into a PluginError."""
    having = {name: getattr(spec, name) for name in FUNCTIONS}
    given: dict[str, Any] = {
        name: _guarded(spec, name, each) for name, each in having.items() if each is not None
    }
    return replace(spec, **given)


def _guarded(spec: NodeSpec, name: str, function: Callable[P, R]) -> Callable[P, R]:
    @wraps(function)
    def call(*arguments: P.args, **named: P.kwargs) -> R:
        try:
            return function(*arguments, **named)
        except (MomantuError, RecursionError):
            raise
        except PLUGIN_ERRORS as error:
            raise PluginError(
                f"the node {spec.yaml[0]!r} is broken: its spec's `{name}` raised "
                f"{words_of(error)}",
                hint="Tell its authors, or uninstall its package.",
            ) from error

    return call
