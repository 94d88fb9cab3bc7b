"""A node's description: for the terminal, for programs and as a page of the docs."""

from __future__ import annotations

from typing import Any

from momantu_bt.tree.catalogue.spec import Kind, NodeSpec
from momantu_bt.tree.show.skill_page import port_data, port_lines, port_tables

_CHILDREN = {
    Kind.LEAF: "no children",
    Kind.DECORATOR: "one child: `child:`, or the node that it stands beside",
}


def node_text(spec: NodeSpec) -> str:
    """For the terminal."""
    lines = [f"{spec.yaml[0]}: {spec.doc}", *port_lines(spec)]
    lines += ["", f"Kind      {spec.kind}", f"In XML    {spec.type}"]
    return "\n".join([*lines, f"Children  {_children(spec)}"])


def node_data(spec: NodeSpec) -> dict[str, Any]:
    """For programs, as JSON."""
    return {
        "name": spec.yaml[0],
        "type": spec.type,
        "kind": str(spec.kind),
        "doc": spec.doc,
        "ports": [port_data(port) for port in spec.ports.values()],
        "one_of": [list(group) for group in spec.one_of],
        "children": list(spec.children),
    }


def node_markdown(spec: NodeSpec) -> str:
    """A page of the docs."""
    about = f"A {spec.kind} node with {_children(spec)}. In XML it is `<{spec.type}>`."
    return "\n\n".join([f"# {spec.yaml[0]}", spec.doc, about, *port_tables(spec)]) + "\n"


def _children(spec: NodeSpec) -> str:
    least, most = spec.children
    if spec.kind in _CHILDREN:
        return _CHILDREN[spec.kind]
    if most is None:
        return f"at least {least} children"
    return f"{least} children" if least == most else f"{least} to {most} children"
