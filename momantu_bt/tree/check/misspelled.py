"""Misspelled and forgotten names of ports: told once, and read as what they mean.

Without this, a wrong letter in a declared input would be an error at each node that runs the tree,
and again at each line in it that reads the input.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from momantu_bt.formats.names import listed, nearest
from momantu_bt.formats.places import Place, lines_of, within
from momantu_bt.tree.catalogue import MODIFIERS, SUBTREE
from momantu_bt.tree.check.keys.shared import scripts_of
from momantu_bt.tree.check.nodes import (
    bare_key,
    check_key,
    report_unknown_port,
    with_nodes,
)
from momantu_bt.tree.check.signatures import Context, Signature
from momantu_bt.tree.model import (
    BROKEN,
    FIRST_INPUT,
    Document,
    Literal,
    Node,
    PortDeclaration,
    Reference,
    Scope,
    Template,
    Tree,
)

_LIKE = 0.7
"""A declared name counts as misspelled from this likeness to the one that is used on."""


def mend_declarations(context: Context) -> None:
    """Give each tree the ports that its callers give and its nodes use, under the name they use.

    A declared port that is nowhere used and near to such a name is misspelled; it is reported and
    renamed. Without one, the port is reported as not declared.
    """
    trees = dict(context.document.trees)
    for name, given in _given(context.document).items():
        tree = trees[name]
        undeclared = [port for port in given if port not in tree.ports]
        if undeclared and not (tree.open or tree.misread):
            trees[name] = _declared(context, tree, undeclared)
    context.redeclare(replace(context.document, trees=trees))


def _given(document: Document) -> dict[str, dict[str, Node]]:
    """The ports that nodes give to each tree: of each, the first such node."""
    found: dict[str, dict[str, Node]] = {}
    for tree in document.trees.values():
        for node in tree.root.walk():
            if node.type == SUBTREE and node.target in document.trees:
                ports = found.setdefault(node.target or "", {})
                for name in node.ports:
                    ports.setdefault(name, node)
    return found


def _declared(context: Context, tree: Tree, undeclared: list[str]) -> Tree:
    used = _used(context, tree)
    both = used.read | used.written
    ports, forgotten = dict(tree.ports), []
    for name in undeclared:
        unused = [port for port in ports if port not in both]
        near = nearest(name, unused, least=_LIKE) if name in both else None
        if near is not None:
            _report_misspelled(context, tree, ports[near], name)
            renamed = {port: name if port == near else port for port in ports}
            ports = {renamed[p]: replace(each, name=renamed[p]) for p, each in ports.items()}
        elif name in both:
            forgotten.append(name)
    outputs = used.written - used.read
    for direction in ("in", "out"):
        names = [name for name in forgotten if (name in outputs) == (direction == "out")]
        if names:
            place = _report_undeclared(context, tree, names, direction)
            lenient = Reference(BROKEN) if direction == "in" else None  # others need not give it
            declared = (PortDeclaration(n, direction, "any", place, lenient) for n in names)
            ports |= {port.name: port for port in declared}
    return replace(tree, ports=ports)


@dataclass(slots=True)
class _Used:
    read: set[str] = field(default_factory=set)
    written: set[str] = field(default_factory=set)


def _used(context: Context, tree: Tree) -> _Used:
    """The keys of its own board that a tree's nodes read and write."""
    found = _Used()
    for node in tree.root.walk():
        signature = context.signature(node)
        for name, value in node.ports.items():
            port = None if signature is None else signature.ports.get(name)
            into = found.written if port is not None and port.direction == "out" else found.read
            parts = value.parts if isinstance(value, Template) else (value,)
            into.update(
                each.key
                for each in parts
                if isinstance(each, Reference) and each.scope is Scope.LOCAL
            )
        for script in scripts_of(context, node):
            found.read.update(variable.key for variable in script.reads)
            found.written.update(variable.key for variable in script.writes)
    return found


def _report_misspelled(context: Context, tree: Tree, port: PortDeclaration, name: str) -> None:
    kind = "output" if port.direction == "out" else "input"
    where = Place(port.place.file, port.place.line, 1)
    shown = context.wire(name, port.place)
    message = f"nothing in {tree.name} uses the {kind} {port.name!r}; its nodes use {shown}"
    place = within(where, port.name, context.document.source)
    context.problems.error("unknown-port", place, message, f"did you mean {name}?")


def _report_undeclared(context: Context, tree: Tree, names: list[str], direction: str) -> Place:
    """Report ports that are used inside and given outside; returns where to declare them."""
    beside = [port for port in tree.ports.values() if port.direction == direction]
    others = beside or [*tree.ports.values()]
    place = others[0].place if others else tree.place
    kind, section = ("input", "inputs") if direction == "in" else ("output", "outputs")
    wires = listed([context.wire(name, place) for name in names])
    said = f"does not declare the {kind}{'s' * (len(names) > 1)} {listed(names)}"
    message = f"{tree.name} uses {wires} and is given a value, but {said}"
    hint = f"write `{section}: {{" + ", ".join(f"{name}: TYPE" for name in names) + "}`"
    if others:
        hint = f"under `{section}:` add " + ", ".join(f"`{name}: TYPE`" for name in names)
    if context.in_xml(place):
        hint = f'write <{kind}_port name="{names[0]}"/> in the model of {tree.name}'
    context.problems.error("unknown-port", place, message, hint)
    return place


def mend_ports(context: Context) -> None:
    """Report misspelled ports and keys without their sign, and give nodes what they mean."""
    trees: dict[str, Tree] = {}
    for name, tree in context.document.trees.items():
        mended = {id(n): new for n in tree.root.walk() for new in _mended(context, tree, n)}
        trees[name] = with_nodes(tree, mended)
    context.document = replace(context.document, trees=trees)


def _mended(context: Context, tree: Tree, node: Node) -> Iterator[Node]:
    """The node with mended ports; nothing for one whose ports have the names of its kind."""
    signature = context.signature(node)
    if signature is None or signature.unknown:
        return
    wrong = [n for n in node.ports if n not in signature.ports and n != FIRST_INPUT]
    meant = {name: _meant(node, name, signature) for name in wrong if name not in MODIFIERS}
    found = {name: _key_without_sign(context, node, name, signature) for name in node.ports}
    keys = {name: key for name, key in found.items() if key and key in _used(context, tree).read}
    if not keys and not any(meant.values()):
        return
    copy = replace(node, ports=dict(node.ports), port_places=dict(node.port_places))
    copy.port_name_places = dict(node.port_name_places)
    for name, key in keys.items():
        if node.ports[name] != Reference(BROKEN):
            check_key(context, node, name, signature)
        copy.ports[name] = Reference(key)
    for name, near in meant.items():
        if near is None or near in copy.ports:
            continue
        report_unknown_port(context, node, name, signature, near)
        copy.ports[near] = copy.ports.pop(name)
        for places in (copy.port_places, copy.port_name_places):
            if name in places:
                places[near] = places.pop(name)
    yield copy


def _key_without_sign(context: Context, node: Node, name: str, signature: Signature) -> str:
    """The key that `seen` or `{seen}` may mean at an output; empty for all else."""
    port, value = signature.ports.get(name), node.ports[name]
    if port is None or port.direction != "out":
        return ""
    if isinstance(value, Literal):
        return bare_key(str(value.value))
    place = node.port_places.get(name)
    if value != Reference(BROKEN) or place is None:
        return ""
    line = lines_of(context.document.source.get(place.file, ""))[place.line - 1]
    return bare_key(line[place.column - 1 : place.column - 1 + place.length])


def _meant(node: Node, name: str, signature: Signature) -> str | None:
    lacking = [
        port for port in signature.ports if port not in node.ports and port not in node.port_places
    ]
    near = nearest(name, lacking)
    needed = [port for port in lacking if signature.ports[port].required]
    others = [n for n in node.ports if n not in signature.ports and n != FIRST_INPUT]
    sole = needed[0] if len(needed) == 1 and others == [name] else None
    return near or sole  # the only unknown port is the only one that is missing
