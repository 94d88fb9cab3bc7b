"""The signature of each node: what it reads, writes, commands and fails with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.formats.places import Place
from momantu_bt.plugins import PluginError, installed_names
from momantu_bt.robot import RobotDescription
from momantu_bt.skill import Port, Skill
from momantu_bt.tree.catalogue import AUTOREMAP, NODES, SUBTREE, NodeSpec, is_ours
from momantu_bt.tree.catalogue.nodes import DOCTOR, why_broken
from momantu_bt.tree.language import is_xml
from momantu_bt.tree.model import BROKEN, Document, Node, Reference, Scope, Tree
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.registry import Registry
from momantu_bt.values.types import parse_type
from momantu_bt.world import Site

_AUTOREMAP_PORT = Port(AUTOREMAP, "in", bool, "whether keys of one name are one key", False)


@dataclass(frozen=True, slots=True)
class Signature:
    """One kind of node. said: its name in the file. first: the input that a bare value sets.

    spec: set for a built-in node. skill: set for a skill. Both are None for a subtree.
    """

    said: str
    ports: Mapping[str, Port]
    first: str | None
    spec: NodeSpec | None = None
    skill: type[Skill] | None = None

    @property
    def one_of(self) -> tuple[tuple[str, ...], ...]:
        """Groups of inputs; a tree gives exactly one of each."""
        owner = self.spec or self.skill
        return () if owner is None else owner.one_of

    def inputs(self) -> list[str]:
        """Names of its inputs."""
        return [name for name, port in self.ports.items() if port.direction == "in"]


@dataclass(slots=True)
class Context:
    """One check of one document. site, description: None without a world or robot."""

    document: Document
    registry: Registry
    problems: Problems
    site: Site | None = None
    description: RobotDescription | None = None
    _skills: dict[str, type[Skill] | None] = field(default_factory=dict)
    _trees: dict[str, Signature] = field(default_factory=dict)
    _xml_files: dict[str, bool] = field(default_factory=dict)

    def signature(self, node: Node) -> Signature | None:
        """The signature of this node; None if it is unknown or broken."""
        spec = NODES.get(node.type)
        if spec is not None:
            said = node.type if self.in_xml(node.place) else spec.yaml[0]
            return Signature(said, spec.ports, spec.first, spec=spec)
        if node.type == SUBTREE:
            return self._call_signature(node, self.document.trees[node.target or ""])
        skill = None if node.type == BROKEN else self.skill(node.type)
        if skill is None:
            return None
        return Signature(node.type, skill.ports, _first(skill.ports), skill=skill)

    def _call_signature(self, node: Node, tree: Tree) -> Signature:
        """The signature of a subtree; for an open tree, with all keys that this node gives."""
        declared = self.tree_signature(tree)
        ports = dict(declared.ports)
        if AUTOREMAP in node.ports:
            ports[AUTOREMAP] = _AUTOREMAP_PORT
        for name in node.ports if tree.open else ():
            if name and name not in ports:
                ports[name] = Port(name, "inout", object, "")
        return Signature(tree.name, ports, declared.first)

    def in_xml(self, place: Place) -> bool:
        """Whether the file of a place is XML, so that messages use XML's words."""
        known = self._xml_files.get(place.file)
        if known is None:
            text = self.document.source.get(place.file, "")
            known = is_xml(place.file, text)
            self._xml_files[place.file] = known
        return known

    def wire(self, key: str, place: Place) -> str:
        """A reference to a key in the format of the file of a place."""
        return f"{{{key}}}" if self.in_xml(place) else f"${key}"

    def wire_to(self, reference: Reference, place: Place) -> str:
        """As `wire`, for a reference with its parts, or to a key of the root's board."""
        at = "@" if reference.scope is Scope.ROOT else ""
        return self.wire(at + ".".join((reference.key, *reference.fields)), place)

    def tree_signature(self, tree: Tree) -> Signature:
        """The ports of a subtree. An unknown type counts as `any`; `tree_ports` reports it."""
        if tree.name not in self._trees:
            ports: dict[str, Port] = {}
            for name, declaration in tree.ports.items():
                try:
                    ports[name] = declaration.port()
                except KeyError:
                    ports[name] = Port(name, declaration.direction, object, declaration.doc)
            self._trees[tree.name] = Signature(tree.name, ports, _first(ports))
        return self._trees[tree.name]

    def skill(self, name: str) -> type[Skill] | None:
        """A skill's class; None if there is none, or if it is broken, which is reported."""
        if name not in self._skills:
            try:
                self._skills[name] = self.registry.skills[name]
            except (KeyError, PluginError):
                self._skills[name] = None
        return self._skills[name]

    def names_of(self, kind: str) -> tuple[str, ...] | None:
        """Valid values of an input with `names=kind`; None when they are unknown."""
        if "." in kind:
            return installed_names(kind)
        if kind == "named_pose":
            return None if self.description is None else tuple(self.description.named_poses)
        if self.site is None:
            return None
        return self.site.known_places() if kind == "place" else tuple(self.site.surfaces)


def _first(ports: Mapping[str, Port]) -> str | None:
    return next((name for name, port in ports.items() if port.direction == "in"), None)


def report_unknown_node(context: Context, node: Node) -> None:
    """Report that no node has this name, or why the skill of this name cannot be used."""
    name = node.type
    broken = _why_broken(context, name)
    if broken is not None:
        context.problems.error("broken-plugin", node.place, broken, DOCTOR)
        return
    xml = context.in_xml(node.place)
    spellings = [_tag(type_) if xml else spec.yaml[0] for type_, spec in NODES.items()]
    skills = [*context.document.trees, *context.registry.skills]
    near = nearest(name, [*skills, *spellings])
    hint = f"did you mean {near}?" if near else valid_names(name, skills, "trees and skills")
    context.problems.error("unknown-node", node.place, f"no node is called {name!r}", hint)


def _tag(type_: str) -> str:
    """The tag of a node of the language in XML."""
    return f"momantu:{type_}" if is_ours(type_) else type_


def _why_broken(context: Context, name: str) -> str | None:
    """Why the plug-in of this name cannot be used; None if it can."""
    try:
        if name in context.registry.skills:
            context.registry.skills[name]
    except PluginError as error:
        return str(error)
    return why_broken(name)


def known_type(text: str) -> Any:
    """The type of a name, or None."""
    try:
        return parse_type(text)
    except KeyError:
        return None
