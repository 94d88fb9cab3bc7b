"""The signature of each node: what it reads, writes, commands and fails with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from momantu_bt.formats.places import Place
from momantu_bt.plugins import PluginError, installed_names
from momantu_bt.robot import RobotDescription
from momantu_bt.skill import Port, Skill
from momantu_bt.tree.catalogue import AUTOREMAP, NODES, SUBTREE, NodeSpec
from momantu_bt.tree.catalogue.nodes import said_type
from momantu_bt.tree.check.declared import declared_spec, models_of, used_spec
from momantu_bt.tree.check.floor import Floor, floor_of
from momantu_bt.tree.language import is_xml
from momantu_bt.tree.model import (
    BROKEN,
    Document,
    Literal,
    Node,
    NodeModel,
    Reference,
    Scope,
    Tree,
)
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.registry import Registry
from momantu_bt.values.types import parse_type
from momantu_bt.world import Site, WorldEntry

_AUTOREMAP_PORT = Port(AUTOREMAP, "in", bool, "whether keys of one name are one key", False)


@dataclass(frozen=True, slots=True)
class Signature:
    """One kind of node. said: its name in the file. first: the input that a bare value sets.

    spec: set for a built-in node, a plug-in node and a node that only a file's model declares.
    skill: set for a skill. Both are None for a subtree. unknown: nothing is known but what the node
    itself shows.
    """

    said: str
    ports: Mapping[str, Port]
    first: str | None
    spec: NodeSpec | None = None
    skill: type[Skill] | None = None
    unknown: bool = False

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
    """One check of one document. site, entry, description: None without a world or robot.

    tolerant: what stands elsewhere (nodes, trees, keys) is a warning and not an error.
    """

    document: Document
    registry: Registry
    problems: Problems
    tolerant: bool = False
    site: Site | None = None
    entry: WorldEntry | None = None
    description: RobotDescription | None = None
    _keys: frozenset[str] | None = None
    _floor: list[Floor | None] = field(default_factory=list)
    _skills: dict[str, type[Skill] | None] = field(default_factory=dict)
    _trees: dict[str, Signature] = field(default_factory=dict)
    _xml_files: dict[str, bool] = field(default_factory=dict)
    _models: dict[str, NodeModel] | None = None
    _declared: dict[str, NodeSpec] = field(default_factory=dict)

    def signature(self, node: Node) -> Signature | None:
        """The signature of this node; None if it is broken."""
        spec = NODES.get(node.type)
        own = self._own(node, None if spec is None else spec.ports)
        if own is not None:
            return Signature(node.type, own.ports, own.first, spec=own)
        if spec is not None:
            said = node.type if self.in_xml(node.place) else spec.yaml[0]
            return Signature(said, spec.ports, spec.first, spec=spec)
        if node.type == SUBTREE:
            tree = self.document.trees.get(node.target or "")
            if tree is not None:
                return self._call_signature(node, tree)
            spec = used_spec(node)
            return Signature(node.target or "", spec.ports, None, spec=spec, unknown=True)
        if node.type == BROKEN:
            return None
        skill = self.skill(node.type)
        if skill is not None:
            return Signature(node.type, skill.ports, _first(skill.ports), skill=skill)
        declared = self.declared(node.type)
        spec = declared or used_spec(node)
        said = said_type(node.type)
        return Signature(said, spec.ports, spec.first, spec=spec, unknown=declared is None)

    def _own(self, node: Node, ports: Mapping[str, Port] | None) -> NodeSpec | None:
        """The file's own model of a node, where it means another node than what is installed.

        The node then has a port of the model that the installed node of this name lacks. ports: of
        the installed node, or None for a skill.
        """
        model = self.models.get(node.type)
        if model is None:
            return None
        if ports is None:
            skill = self.skill(node.type)
            if skill is None:
                return None
            ports = skill.ports
        names = {port.name for port in model.ports} & node.ports.keys()
        return self.declared(node.type) if names - ports.keys() else None

    def declared(self, name: str) -> NodeSpec | None:
        """What a model of the file says of a node; None without a model."""
        if name not in self._declared and name in self.models:
            self._declared[name] = declared_spec(self.models[name])
        return self._declared.get(name)

    @property
    def models(self) -> dict[str, NodeModel]:
        """The models of nodes that the document has."""
        if self._models is None:
            self._models = models_of(self.document)
        return self._models

    def _call_signature(self, node: Node, tree: Tree) -> Signature:
        """The signature of a subtree; for an open tree, with all keys that this node gives."""
        declared = self.tree_signature(tree)
        ports = dict(declared.ports)
        if AUTOREMAP in node.ports:
            ports[AUTOREMAP] = _AUTOREMAP_PORT
        for name in node.ports if tree.open or tree.misread else ():
            if name and name not in ports:
                ports[name] = Port(name, "inout", object, "")
        return Signature(tree.name, ports, declared.first)

    def redeclare(self, document: Document) -> None:
        """Go on with another document, whose trees may declare other ports."""
        self.document = document
        self._trees.clear()

    def tell_elsewhere(self, code: str, place: Place, message: str, hint: str = "") -> None:
        """Report something that may stand elsewhere: an error, or a warning if tolerant."""
        tell = self.problems.warning if self.tolerant else self.problems.error
        tell(code, place, message, hint)

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
                    port = declaration.port()
                    may_lack = tree.misread and port.required
                    ports[name] = replace(port, default=None) if may_lack else port
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

    @property
    def floor(self) -> Floor | None:
        """The floor plan, as the robot is told it; read when a tree gives the first pose."""
        if not self._floor:
            self._floor.append(floor_of(self.entry, self.description))
        return self._floor[0]

    @property
    def keys(self) -> frozenset[str]:
        """The names of all keys that some wire, declared port or value of the document has."""
        if self._keys is None:
            found = {*self.document.values}
            for tree in self.document.trees.values():
                found |= {*tree.ports}
                for node in tree.root.walk():
                    found |= {v.key for v in node.ports.values() if isinstance(v, Reference)}
            self._keys = frozenset(found)
        return self._keys

    def meant_key(self, value: object, place: Place) -> str:
        """The hint for the name of a key that is written without its sign; else empty."""
        known = isinstance(value, str) and value in self.keys
        return f"did you mean {self.wire(str(value), place)}?" if known else ""

    def names_of(self, kind: str) -> tuple[str, ...] | None:
        """Valid values of an input with `names=kind`; None when they are unknown."""
        if "." in kind:
            return installed_names(kind)
        if kind == "named_pose":
            poses = () if self.description is None else tuple(self.description.named_poses)
            return poses or None  # a robot without an arm has none, and runs no node that needs one
        if self.site is None:
            return None
        if kind == "tag":
            return tuple(self.site.tags)
        told = self.site.known_places() if kind == "place" else tuple(self.site.surfaces)
        taught = self.taught
        return None if taught is None else (*told, *taught)

    @property
    def taught(self) -> tuple[str, ...] | None:
        """Names that nodes of the document give to places; None if one is not written out."""
        names: dict[str, None] = {}
        for tree in self.document.trees.values():
            for node in tree.root.walk():
                skill = None if node.type in NODES else self.skill(node.type)
                for port in () if skill is None else skill.ports.values():
                    value = node.ports.get(port.name)
                    if port.names != "taught" or value is None:
                        continue
                    if not isinstance(value, Literal) or not isinstance(value.value, str):
                        return None
                    names[value.value] = None
        return tuple(names)


def _first(ports: Mapping[str, Port]) -> str | None:
    return next((name for name, port in ports.items() if port.direction == "in"), None)


def known_type(text: str) -> Any:
    """The type of a name, or None."""
    try:
        return parse_type(text)
    except KeyError:
        return None
