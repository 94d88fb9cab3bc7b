"""Checks of single nodes: their names, their children and their ports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from momantu_bt.failure import CODE
from momantu_bt.formats.names import listed, valid_names
from momantu_bt.formats.places import Place
from momantu_bt.messages import VALUE_TYPES
from momantu_bt.skill import MISSING, Port
from momantu_bt.tree.catalogue import AUTOREMAP, MODIFIERS, NODES
from momantu_bt.tree.check.bounds import converted
from momantu_bt.tree.check.names import check_named
from momantu_bt.tree.check.signatures import Context, Signature, known_type
from momantu_bt.tree.model import (
    FIRST_INPUT,
    Document,
    Literal,
    Node,
    PortDeclaration,
    Reference,
    Template,
    Tree,
)
from momantu_bt.values.convert import convert
from momantu_bt.values.kinds import CodeText
from momantu_bt.values.types import assignable, label
from momantu_bt.values.words import ConversionError


def check_tree_ports(context: Context, tree: Tree) -> None:
    """Check the types and defaults of a tree's inputs and outputs."""
    for name, declaration in tree.ports.items():
        type_ = known_type(declaration.type_name)
        if type_ is None:
            hint = valid_names(declaration.type_name, _type_names(), "types")
            message = f"no type is called {declaration.type_name!r}"
            context.problems.error("unknown-type", declaration.place, message, hint)
        else:
            _check_default(context, name, declaration)


def _check_default(context: Context, name: str, declaration: PortDeclaration) -> None:
    if not isinstance(declaration.default, Literal):
        return
    try:
        convert(declaration.default.value, declaration.port())
    except ConversionError as error:
        message = f"the default of {name!r}: {error}"
        context.problems.error("wrong-value", declaration.place, message)


def _type_names() -> list[str]:
    return [*VALUE_TYPES, *(f"list of {name}" for name in VALUE_TYPES)]


def check_node(context: Context, node: Node) -> None:
    """Check one node: its name, its children and its ports."""
    signature = context.signature(node)
    if signature is None or signature.unknown:
        return
    _check_children(context, node, signature)
    _check_switch(context, node, signature)
    for name in node.ports:
        if name == FIRST_INPUT:
            message = f"{signature.said} has no input"
            place = node.port_places[name]
            context.problems.error("unknown-port", place, message, "remove the value")
        else:
            _check_port(context, node, name, signature)
    _check_one_of(context, node, signature)
    _check_values(context, node, signature)
    missing = [
        port
        for name, port in signature.ports.items()
        if _is_needed(port, signature) and name not in node.ports and name not in node.port_places
    ]
    if missing and not autoremaps(node):
        _report_missing(context, node, missing, signature)


def _is_needed(port: Port, signature: Signature) -> bool:
    """Whether it must be given: an output of a built-in node, too, unless it has a default."""
    written = port.direction == "out" and port.default is MISSING
    return port.required or (signature.spec is not None and written)


def autoremaps(node: Node) -> bool:
    """Whether a SubTree connects all other keys to the outer keys of the same name."""
    return node.ports.get(AUTOREMAP) == Literal(True)


def with_named_inputs(context: Context) -> Document:
    """A copy of the document in which bare values (`dock: bay_a`) have their ports' names.

    Bare values of unknown nodes stay. Trees without bare values are shared with the original.
    """
    document = context.document
    trees = {name: _with_named_inputs(context, tree) for name, tree in document.trees.items()}
    return replace(document, trees=trees)


def _with_named_inputs(context: Context, tree: Tree) -> Tree:
    named: dict[int, Node] = {}
    for node in tree.root.walk():
        signature = context.signature(node) if FIRST_INPUT in node.ports else None
        if signature is not None and signature.first is not None:
            named[id(node)] = copy = replace(node)
            _name_first_input(copy, signature.first)
    return with_nodes(tree, named)


def with_nodes(tree: Tree, changed: Mapping[int, Node]) -> Tree:
    """A copy of the tree with some nodes changed; the tree itself if there are none.

    changed: the new node for the `id` of an old one. Its children and handlers do not count.
    """
    if not changed:
        return tree
    copies: dict[int, Node] = {}
    for node in reversed(list(tree.root.walk())):  # innermost first: trees may be deep
        copy = copies[id(node)] = replace(changed.get(id(node), node))
        copy.children = [copies[id(child)] for child in node.children]
        copy.handlers = [
            each if each.node is None else replace(each, node=copies[id(each.node)])
            for each in node.handlers
        ]
    return replace(tree, root=copies[id(tree.root)])


def _name_first_input(node: Node, first: str) -> None:
    """Put the bare value of a new node where the port of this name has its value."""
    ports, place = dict(node.ports), node.port_places[FIRST_INPUT]
    value = ports.pop(FIRST_INPUT)
    node.ports = {**ports, first: value}
    node.port_places = {**_without_first(node.port_places), first: place}
    node.port_name_places = {**_without_first(node.port_name_places), first: place}


def _without_first(places: Mapping[str, Place]) -> dict[str, Place]:
    return {name: place for name, place in places.items() if name != FIRST_INPUT}


def _children(count: int) -> str:
    return "1 child" if count == 1 else f"{count or 'no'} children"


def _check_children(context: Context, node: Node, signature: Signature) -> None:
    if signature.spec is None:
        if node.children:
            message = f"{signature.said} takes no children"
            context.problems.error("children", node.children[0].place, message, "remove them")
        return
    least, most = signature.spec.children
    count = len(node.children)
    if count < least and not signature.spec.positions:
        message = f"{signature.said} has {_children(count)}; at least {least}"
        context.problems.error("children", node.place, message)
    elif count < least and count == 0 and signature.spec.positions == ("child",):
        message = f"{signature.said} has no child"
        context.problems.error("children", node.place, message, _child_hint(context, node))
    elif most is not None and count > most:
        message = f"{signature.said} has {_children(count)}; at most {most}"
        context.problems.error("children", node.place, message)


def _child_hint(context: Context, node: Node) -> str:
    return "put one node inside" if context.in_xml(node.place) else "write `child:` among its ports"


def _check_one_of(context: Context, node: Node, signature: Signature) -> None:
    """Check that exactly one input of a group is given, such as of `duration` and `msec`."""
    for group in signature.one_of:
        nothing = [name for name in group if node.ports.get(name) == Literal(None)]
        named = [name for name in group if name in node.port_places or name in node.ports]
        given = [name for name in named if name not in nothing]
        if not given and signature.skill is not None:
            message = f"{signature.said} needs exactly one of the inputs {', '.join(group)}"
            context.problems.error("missing-input", node.place, message)
        elif not given:
            first = group[-1] if context.in_xml(node.place) else group[0]
            _report_missing(context, node, [signature.ports[first]], signature)
        for name in given[1:]:
            message = f"{signature.said} takes {given[0]!r} or {name!r}, not both"
            place = node.port_name_places.get(name, node.place)
            context.problems.error("one-of", place, message, "remove one")


def _check_values(context: Context, node: Node, signature: Signature) -> None:
    """Run the checks of values that the node's spec defines."""
    objection = None if signature.spec is None else signature.spec.objection
    found = None if objection is None else objection(node)
    if found is not None:
        place = node.port_places.get(found.port, node.place)
        context.problems.error("wrong-value", place, found.message, found.hint)


def _check_switch(context: Context, node: Node, signature: Signature) -> None:
    """Report a switch whose variable is a literal, as it always chooses the same child."""
    value = node.ports.get("variable")
    if signature.spec is None or not signature.spec.switch or not isinstance(value, Literal):
        return
    place = node.port_places.get("variable", node.place)
    message = f"`{signature.said}` chooses by a key"
    hint = f"write {context.wire(str(value.value), place)}"
    context.problems.error("not-a-key", place, message, hint)


def _report_missing(
    context: Context, node: Node, ports: Sequence[Port], signature: Signature
) -> None:
    """Report the ports that a node needs and lacks: all of them in one error."""
    xml = signature.spec.xml if signature.spec is not None and context.in_xml(node.place) else {}
    names = [repr(xml.get(port.name, port.name)) for port in ports]
    kind = "input" if all(port.direction == "in" for port in ports) else "key"
    several = f"{kind}s" if len(ports) > 1 else kind
    message = f"{signature.said} needs the {several} {listed(names)}"
    hint = "; ".join(_described(port, xml.get(port.name, port.name)) for port in ports)
    by_model = signature.spec is not None and node.type not in NODES
    tell = context.tell_elsewhere if by_model else context.problems.error
    tell("missing-input", node.place, message, hint)


def _described(port: Port, name: str) -> str:
    unit = f" in {port.unit}" if port.unit else ""
    return f"{name}: {label(port.type)}{unit}" + (f", {port.doc}" if port.doc else "")


def _check_port(context: Context, node: Node, name: str, signature: Signature) -> None:
    port = signature.ports.get(name)
    if port is None:
        report_unknown_port(context, node, name, signature)
        return
    value = node.ports[name]
    place = node.port_places.get(name, node.place)
    watched = signature.spec is not None and name in signature.spec.keys
    if port.direction == "out" or watched:
        check_key(context, node, name, signature)
    elif isinstance(value, Literal):
        check_literal(context, value, place, port)
    elif isinstance(value, Template) and not assignable(str, port.type):
        message = f"{name!r} of {signature.said} is not a text: {label(port.type)}"
        context.problems.error("wrong-type", place, message, "write $key alone")


def bare_key(text: str) -> str:
    """What a text without signs of a wire names: `seen` for `{seen`; empty if it is no key."""
    key = text.strip("{}$")
    return key if key.isidentifier() else ""


def check_key(context: Context, node: Node, name: str, signature: Signature) -> None:
    """Check that a port which writes or watches a key is given a whole key."""
    port, value = signature.ports[name], node.ports[name]
    place = node.port_places.get(name, node.place)
    doing = "written" if port.direction == "out" else "watched"
    if isinstance(value, Reference):
        if value.fields:
            message = f"a part of a value cannot be {doing}"
            hint = f"write {context.wire(value.key, place)}"
            context.problems.error("not-a-key", place, message, hint)
        return
    key = bare_key(str(value.value)) if isinstance(value, Literal) else "key"
    hint = f"did you mean {context.wire(key, place)}?" if key else ""
    hint = hint or f"write {context.wire('key', place)}"
    what = "is an output of" if port.direction == "out" else "names what is watched by"
    message = f"{port.name!r} {what} {signature.said}: it needs a key"
    context.problems.error("not-a-key", place, message, hint)


def check_literal(context: Context, value: Literal, place: Place, port: Port) -> None:
    """Check a literal against a port: its type, its unit, and the names that are valid."""
    if port.type is CodeText and isinstance(value.value, str) and not CODE.fullmatch(value.value):
        hint = "upper-case words joined by underscores, such as NOT_FOUND"
        context.problems.error("bad-code", place, f"{value.value!r} is not a failure code", hint)
        return
    try:
        found = converted(value.value, port)
    except ConversionError as error:
        message = f"{port.name!r}: {error}"
        hint = context.meant_key(value.value, place)
        context.problems.error("wrong-value", place, message, hint)
        return
    check_named(context, found, place, port)


def report_unknown_port(
    context: Context, node: Node, name: str, signature: Signature, meant: str = ""
) -> None:
    """Report a port that a node does not have. meant: the port that it means, if that is known."""
    place = node.port_name_places.get(name, node.place)
    if name in MODIFIERS:
        context.problems.error(
            "misplaced-modifier",
            place,
            f"`{name}` is a modifier, not a port of {signature.said}",
            f"move `{name}` left, under `{signature.said}`",
        )
        return
    hint = f"did you mean {meant}?" if meant else valid_names(name, signature.ports, "ports")
    if not signature.ports:
        hint = f"{signature.said} has no ports"
        if signature.spec is None and signature.skill is None:
            section = "the model" if context.in_xml(place) else "`inputs:` or `outputs:`"
            hint = f"declare it in {section} of {signature.said}"
    context.problems.error("unknown-port", place, f"{signature.said} has no port {name!r}", hint)
