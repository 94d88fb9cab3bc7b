"""The rules that a plug-in node must keep; checked when it is loaded."""

from __future__ import annotations

import re
from collections.abc import Collection

from momantu_bt.formats.yaml.core import resolve
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue.built_in import BUILT_IN
from momantu_bt.tree.catalogue.guarded import FUNCTIONS
from momantu_bt.tree.catalogue.spec import Kind, NodeSpec
from momantu_bt.tree.catalogue.words import (
    CONDITIONS,
    EXPLICIT,
    FORCED,
    NODE_KEYS,
    SUBTREE,
    WORDS_OF_TREES,
)
from momantu_bt.tree.language import NODE_NAME, NODE_NAME_HINT
from momantu_bt.values.kinds import is_type

_SNAKE = re.compile(r"[a-z][a-z0-9_]*")
_RESERVED = (*WORDS_OF_TREES, *CONDITIONS, *NODE_KEYS, *EXPLICIT, SUBTREE, "force", "switch")
_LATER = "give the entry point another name"


def node_objection(name: str, plugin: object, built_in: Collection[str]) -> str | None:
    """Why trees cannot use a plug-in as a node; None if they can.

    name: of the entry point. built_in: YAML names of the built-in nodes.
    """
    if not isinstance(plugin, type):
        return f"{type(plugin).__name__} is not a class"
    if not callable(getattr(plugin, "execute", None)):
        return f"{plugin.__name__} is not a subclass of momantu_bt.engine.node.TreeNode"
    spec = getattr(plugin, "spec", None)
    if not isinstance(spec, NodeSpec):
        return f"{plugin.__name__} has no `spec`: write control(…), decorator(…) or leaf(…)"
    return (
        bad_name(name, built_in)
        or _bad_spelling(name, spec)
        or _bad_types(spec)
        or _bad_spec(spec)
        or next(filter(None, (bad_port(name, port) for port in spec.ports.values())), None)
        or _without_step(plugin)
    )


def type_of(name: str) -> str:
    """The canonical type for a YAML name: `EveryNth` for `every_nth` and for `EveryNth`."""
    if not _SNAKE.fullmatch(name):
        return name
    return "".join(word.capitalize() for word in name.split("_"))


def unusable_name(name: str, what: str) -> str | None:
    """Why no plug-in that is a node of trees can have this name; None if it can.

    what: "a skill" or "a node".
    """
    if not NODE_NAME.fullmatch(name):
        return f"{name!r} is not a name for {what}: {NODE_NAME_HINT}"
    if name in _RESERVED or not isinstance(resolve(name), str):
        return f"{name!r} is a word of tree files; {_LATER}"
    return None


def bad_name(name: str, built_in: Collection[str]) -> str | None:
    """Why a node cannot have this name; None if it can."""
    if name in built_in or type_of(name) in BUILT_IN or type_of(name) == SUBTREE:
        return f"{name!r} is a built-in node; {_LATER}"
    if name in FORCED or name == "cases":
        return f"{name!r} is a word of tree files; {_LATER}"
    return unusable_name(name, "a node")


def _bad_spelling(name: str, spec: NodeSpec) -> str | None:
    if spec.yaml != (name,):
        return f"its spec is spelled {' and '.join(spec.yaml)}, and its entry point {name}"
    if spec.type != type_of(name):
        return f"its spec has the type {spec.type!r}; of {name!r} it is {type_of(name)!r}"
    return None


def _bad_types(spec: NodeSpec) -> str | None:
    """What is wrong with the first argument of the spec that has a wrong type; None if all fit."""
    for argument in FUNCTIONS:
        value = getattr(spec, argument)
        if value is None and argument not in ("flow", "codes"):
            continue
        if not callable(value):
            example = "; write and_also('CODE')" if argument == "codes" else ""
            return f"its spec's `{argument}` is {value!r}; expected a function{example}"
    least, most = spec.children if _is_pair(spec.children) else (None, None)
    if not isinstance(least, int) or not isinstance(most, int | None):
        return f"its spec's `children` is {spec.children!r}; expected (least, most), such as (2, 5)"
    if not isinstance(spec.doc, str):
        return f"its spec's doc is {spec.doc!r}; expected one sentence"
    return None


def _is_pair(value: object) -> bool:
    return isinstance(value, tuple) and len(value) == 2


def _without_step(plugin: type) -> str | None:
    if getattr(getattr(plugin, "step", None), "__isabstractmethod__", False):
        return f"{plugin.__name__} has no `step`: the method that is one tick of the node"
    return None


def _bad_spec(spec: NodeSpec) -> str | None:
    least, most = spec.children
    if not spec.doc.strip():
        return "its spec has no doc: one sentence that says what it does"
    if spec.switch or spec.handlers:
        return "`switch` and `handlers` are for built-in nodes; take children instead"
    if spec.kind is Kind.LEAF and most != 0:
        return "its spec is a leaf's and has children; write control(…)"
    if spec.kind is Kind.CONTROL and spec.positions:
        return "`positions` are for built-in control nodes; take a list of children"
    if least < 0 or (most is not None and most < least):
        return f"its spec has from {least} to {most} children; expected least and most"
    if spec.first is not None and spec.first not in spec.ports:
        return f"its spec's `first` is {spec.first!r}, and it has no such port"
    named = (*spec.keys, *spec.may_be_empty, *spec.copies, *spec.copies.values(), *spec.xml)
    named += (*(spec.item or ()), *(name for group in spec.one_of for name in group))
    missing = next((port for port in named if port not in spec.ports), None)
    return None if missing is None else f"its spec names the port {missing!r}, which it has not"


def bad_port(name: str, port: Port) -> str | None:
    """What is wrong with a node's port; None if it is right."""
    if port.name in ("child", "children"):
        return f"the port {name}.{port.name} would hide what stands below the node; rename it"
    if not isinstance(port.doc, str) or not port.doc.strip():
        return f"the port {name}.{port.name} has no doc"
    if isinstance(port.type, str) or not is_type(port.type):
        return f"the port {name}.{port.name} has no type: {port.type!r} is not one"
    return None
