"""Keys of the root's board: which of them nodes read and write, and what is published there."""

from __future__ import annotations

import keyword
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import make_dataclass
from functools import cache

from momantu_bt.formats.places import NOWHERE, Place
from momantu_bt.messages import RobotState
from momantu_bt.plugins import PluginError
from momantu_bt.service import Service
from momantu_bt.tree.catalogue import NODES, SUBTREE
from momantu_bt.tree.catalogue.known import Key, literal_type
from momantu_bt.tree.catalogue.nodes import DOCTOR
from momantu_bt.tree.check.keys.reads import references
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import Document, Literal, Node, PortValue, Reference, Scope
from momantu_bt.tree.script import ScriptSyntaxError, parse
from momantu_bt.values.kinds import ScriptText

ROBOT_KEY = "robot"
"""The key `$@robot.…`, which every run publishes."""


def root_reads(
    document: Document, node: Node, *, replaced: bool = False
) -> Iterator[tuple[str, Place]]:
    """Names of the keys that a node reads as `$@name`, each with its place.

    replaced: a substitution replaces the node, so only its conditions count.
    """
    places = {**node.port_places, **node.condition_places}
    scripts = dict(node.conditions)
    if not replaced:
        for name, value in _values(document, node):
            for reference in references(value):
                if reference.scope is Scope.ROOT:
                    yield reference.key, places.get(name, node.place)
        scripts |= _scripts(node)
    for name, script in scripts.items():
        try:
            variables = parse(script).reads
        except ScriptSyntaxError:
            continue
        for variable in variables:
            if variable.key.startswith("@"):
                yield variable.key[1:], places.get(name, node.place)


def _values(document: Document, node: Node) -> Iterator[tuple[str, PortValue]]:
    """The values of a node's ports, with the defaults of the tree that it runs; no outputs."""
    spec = NODES.get(node.type)
    ports = {} if spec is None else spec.ports
    for name, value in node.ports.items():
        port = ports.get(name)
        if port is None or port.direction != "out":
            yield name, value
    if node.type == SUBTREE:
        for name, declared in document.trees[node.target or ""].ports.items():
            if name not in node.ports and isinstance(declared.default, Reference):
                yield name, declared.default


def _scripts(node: Node) -> dict[str, str]:
    """The scripts in a node's ports."""
    spec = NODES.get(node.type)
    ports = {} if spec is None else spec.ports
    given = {name: value for name, value in node.ports.items() if isinstance(value, Literal)}
    return {
        name: str(given[name].value)
        for name, port in ports.items()
        if port.type is ScriptText and name in given
    }


def services_read(context: Context, nodes: Iterable[tuple[Node, bool]]) -> dict[str, Place]:
    """The services whose keys some nodes read, each with the first place where one is read.

    A key that the tree gives a value itself is the tree's, also if a service has the same name.
    nodes: each with whether a substitution replaces it, as in `root_reads`.
    """
    document, services = context.document, context.registry.services
    found: dict[str, Place] = {}
    for node, replaced in nodes:
        for name, place in root_reads(document, node, replaced=replaced):
            if name in services:
                found.setdefault(name, place)
    own = _given(context) if found else frozenset()
    return {name: place for name, place in found.items() if name not in own}


def report_broken_services(context: Context) -> None:
    """Report services that the document reads and that cannot be used."""
    nodes = ((node, False) for tree in context.document.trees.values() for node in tree.root.walk())
    for name, place in services_read(context, nodes).items():
        try:
            context.registry.services[name]
        except PluginError as error:
            context.problems.error("broken-plugin", place, str(error), DOCTOR)


def root_keys(context: Context) -> Mapping[str, Key | None]:
    """Every name that `$@name` can have, with what is known about values nothing overwrites."""
    document = context.document
    start = Place(document.file, 1, 1)
    nodes = ((node, False) for tree in document.trees.values() for node in tree.root.walk())
    read = services_read(context, nodes)
    names: dict[str, Key | None] = dict.fromkeys(context.registry.services)
    names |= {name: _published(context, name) for name in read}
    names[ROBOT_KEY] = Key(RobotState, NOWHERE)
    for name, value in document.values.items():
        place = document.value_places.get(name, start)
        names[name] = Key(literal_type(value), place, (value,))
    names |= dict.fromkeys(_written(context, names))
    return names


def _given(context: Context) -> frozenset[str]:
    """Keys of the root's board that the tree gives a value."""
    return frozenset({*context.document.values, *_written(context, ())})


def _written(context: Context, names: Container[str]) -> Iterator[str]:
    """Keys of the root's board that some node writes. names: those that need not be new."""
    document = context.document
    for tree in document.trees.values():
        for node in tree.root.walk():
            for scope, key, makes in _written_by(context, node):
                on_root = scope is Scope.ROOT or tree.name == document.main
                if on_root and (makes or key in names):
                    yield key


def _written_by(context: Context, node: Node) -> Iterator[tuple[Scope, str, bool]]:
    """Keys that a node's outputs and scripts write: board, key, whether it may be a new one."""
    signature = context.signature(node)
    ports = signature.ports if signature is not None else {}
    scripts = list(node.conditions.values())
    for name, value in node.ports.items():
        port = ports.get(name)
        if port is not None and port.direction != "in" and isinstance(value, Reference):
            yield value.scope, value.key, True
        elif port is not None and port.type is ScriptText and isinstance(value, Literal):
            scripts.append(str(value.value))
    for script in scripts:
        try:
            parsed = parse(script)
        except ScriptSyntaxError:
            continue  # it is an error of its own
        needed = {variable.key for variable in parsed.needs}
        for variable in parsed.writes:
            scope = Scope.ROOT if variable.key.startswith("@") else Scope.LOCAL
            yield scope, variable.key.removeprefix("@"), variable.key not in needed


def _published(context: Context, name: str) -> Key | None:
    """What a service publishes, as far as it is known; None if nothing is."""
    try:
        kind = context.registry.services[name]
    except PluginError:
        return None
    if not (isinstance(kind, type) and issubclass(kind, Service)):
        return None  # a test's registry may give anything
    fields = tuple((key, type_) for key, type_ in kind.publishes.items() if _is_name(key))
    return Key(_record(f"@{name}", fields, kind.__module__), NOWHERE)


@cache
def _record(name: str, fields: tuple[tuple[str, type], ...], module: str) -> type:
    """A dataclass with these fields, so that parts of the key are checked as of other values."""
    return make_dataclass(name, fields, namespace={"__module__": module})


def _is_name(key: str) -> bool:
    return key.isidentifier() and not keyword.iskeyword(key)
