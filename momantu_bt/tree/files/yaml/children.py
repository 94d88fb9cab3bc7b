"""Nodes below a node in YAML: lists, one child, and handlers."""

from __future__ import annotations

from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.catalogue import NodeSpec
from momantu_bt.tree.files.port_values import drop_duplicates
from momantu_bt.tree.files.queue import into_handler
from momantu_bt.tree.files.yaml.misplaced import settle_branches, settle_handlers
from momantu_bt.tree.files.yaml.misspelled import mend_words
from momantu_bt.tree.files.yaml.ports import read_port
from momantu_bt.tree.files.yaml.reading import Reading, said
from momantu_bt.tree.language import AGAIN, handler_codes
from momantu_bt.tree.model import Handler, Node


def read_control(node: Node, value: Raw, spec: NodeSpec, reading: Reading) -> None:
    """Read several children: a list, or ports and `children:`."""
    if isinstance(value, Items):
        reading.children(node, value)
    elif isinstance(value, Entries):
        where, problems = f"`{said(node)}`", reading.problems
        mend_words(value, ("children", *spec.ports), where, problems, holding=("children",))
        split(node, value, spec, ("children",), reading)
    elif value.value is not None:
        reading.misfit(node, value, f"{said(node)} takes a list of nodes")


def read_decorator(node: Node, value: Raw, spec: NodeSpec, reading: Reading) -> None:
    """Read ports and `child:`."""
    if not isinstance(value, Entries):
        hint = f"write `{spec.yaml[0]}: {{…, child: …}}`, or put it beside a node"
        reading.misfit(node, value, f"{said(node)} takes `child:`", hint)
        return
    where, problems = f"`{said(node)}`", reading.problems
    mend_words(value, ("child", *spec.ports), where, problems, holding=("child",))
    for child in split(node, value, spec, ("child",), reading):
        reading.later(child, node.children.append)


def read_handlers(node: Node, value: Raw, spec: NodeSpec, reading: Reading) -> None:
    """Read ports, `try:`, and the handlers under `catch:`."""
    if not isinstance(value, Entries):
        reading.misfit(node, value, f"{said(node)} takes `try:` and `catch:`")
        return
    branches, where = ("try", "catch"), f"`{said(node)}`"
    mend_words(value, (*branches, *spec.ports), where, reading.problems, holding=branches)
    settle_branches(value, spec.ports, reading.problems)
    drop_duplicates(value, reading.problems)
    for raw in split(node, _without(value, "catch"), spec, ("try",), reading):
        reading.later(raw, node.children.append)
    having = {key.text: raw for key, raw in value.entries}
    for name in ("try", "catch"):
        if name not in having:
            reading.error("missing-child", node.place, f"`{said(node)}` without `{name}:`")
    if "catch" in having:
        _handlers(node, having["catch"], spec, reading)


def split(
    node: Node, raw: Entries, spec: NodeSpec | None, kept: tuple[str, ...], reading: Reading
) -> list[Raw]:
    """Give a mapping's ports to the node, and read `children`. Returns the other kept values.

    kept: the keys of the mapping that are not ports.
    """
    drop_duplicates(raw, reading.problems)
    values: list[Raw] = []
    for key, value in raw.entries:
        if key.text not in kept:
            read_port(node, (key.text, key.place), value, spec, reading.problems)
        elif key.text == "children" and isinstance(value, Items):
            reading.children(node, value)
        elif key.text == "children":
            reading.misfit(node, value, "`children` is a list of nodes")
        else:
            values.append(value)
    return values


def _handlers(node: Node, raw: Raw, spec: NodeSpec, reading: Reading) -> None:
    if not isinstance(raw, Entries) or not raw.entries:
        hint = "under it, lines such as `CODE | OTHER_CODE: node`"
        reading.error("wrong-value", raw.place, "`catch` is a mapping of codes to nodes", hint)
        return
    settle_handlers(raw, reading.problems)
    drop_duplicates(raw, reading.problems)
    for key, value in raw.entries:
        codes = handler_codes(key.text, key.place, reading.problems)
        handler = Handler(codes, None, key.place)
        node.handlers.append(handler)
        if isinstance(value, Scalar) and value.text == AGAIN:
            if not spec.tries_again:
                reading.error("again", value.place, "`again` has a meaning in `recover` alone")
            continue
        reading.later(value, into_handler(handler))


def _without(raw: Entries, name: str) -> Entries:
    kept = [(key, value) for key, value in raw.entries if key.text != name]
    return Entries(kept, raw.place, raw.flow)
