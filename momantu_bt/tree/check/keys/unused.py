"""Warnings of values in a file's header that nothing reads."""

from __future__ import annotations

from collections.abc import Iterator

from momantu_bt.formats.names import nearest
from momantu_bt.tree.check.keys.reads import references
from momantu_bt.tree.check.keys.shared import scripts_of
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import Node, Tree


def warn_of_unused_values(context: Context, main: Tree, seen: set[str]) -> None:
    """Warn of each of the document's values that nothing reads.

    seen: the keys of the root's board that something reads. What disabled nodes read counts too.
    """
    document = context.document
    idle = {key for node in main.root.walk() if node.disabled for key in _named(context, node)}
    for name in document.values if not main.open else ():
        if name not in seen | idle:
            place = document.value_places.get(name, main.place)
            near = nearest(name, sorted(seen - document.values.keys()))
            hint = f"did you mean {near}, which is read?" if near else "remove it"
            message = f"nothing reads the value {name!r}"
            context.problems.warning("unused-value", place, message, hint)


def _named(context: Context, top: Node) -> Iterator[str]:
    """Keys that the ports and scripts of a node and those below it mention."""
    for node in top.walk():
        for value in node.ports.values():
            yield from (reference.key for reference in references(value))
        for script in scripts_of(context, node):
            yield from (variable.key for variable in script.reads)
