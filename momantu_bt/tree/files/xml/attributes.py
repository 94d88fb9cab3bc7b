"""The attributes of a node's element: plain ones where BehaviorTree.CPP reads the same value."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from momantu_bt.formats.units import UnitError, in_unit
from momantu_bt.plugins import PluginError
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import AUTOREMAP, NODES, SUBTREE, XML_CONDITIONS, NodeSpec
from momantu_bt.tree.files.scalars import CannotWrite, port_text
from momantu_bt.tree.files.xml.ports import DESCRIPTION, DISABLED, NOTE, PREFIX, RESERVED, names_key
from momantu_bt.tree.files.xml.text import attribute, fits_in_xml
from momantu_bt.tree.files.xml.values import WireError, attribute_value
from momantu_bt.tree.model import (
    Literal,
    Node,
    PortDeclaration,
    PortValue,
    Reference,
    Scope,
)
from momantu_bt.tree.registry import Registry
from momantu_bt.values.kinds import ScriptText, ValueType
from momantu_bt.values.types import parse_type

_NAME = re.compile(r"[A-Za-z_][\w.-]*", re.ASCII)
"""What can be the name of a tag or an attribute, as all parsers agree."""


def is_name(text: str) -> bool:
    """Whether a text can be the name of a tag or an attribute."""
    return _NAME.fullmatch(text) is not None


def plain(value: PortValue, port: str, type_: ValueType) -> str | None:
    """The text that an attribute without prefix has for this value; None if no text gives it."""
    if isinstance(value, Reference):
        at = "@" if value.scope is Scope.ROOT else ""
        text = f"{{{at}{value.key}}}"
    elif isinstance(value, Literal) and isinstance(value.value, str | int | float):
        shown = value.value
        text = str(shown).lower() if isinstance(shown, bool) else _shown(shown)
    else:
        return None
    try:
        found = attribute_value(text, port, type_)
    except WireError:
        return None
    same = found == value and _type(found) is _type(value)
    return text if same and fits_in_xml(text) else None


def port_attribute(name: str, value: PortValue, type_: ValueType) -> str:
    """The attribute of a skill's input or output, without prefix if possible.

    Raises:
        CannotWrite: XML has no such character.
    """
    text = None if _is_reserved(name) else plain(value, name, type_)
    if text is not None:
        return attribute(name, text)
    return attribute(PREFIX + name, port_text(value))


def _is_reserved(name: str) -> bool:
    """Whether an attribute without prefix of this name means something other than a port."""
    return name.startswith("_") or name in RESERVED


def _shown(value: str | float) -> str:
    return value if isinstance(value, str) else repr(value)


def _type(value: PortValue) -> type:
    return type(value.value) if isinstance(value, Literal) else type(value)


@dataclass(frozen=True, slots=True)
class AttributeWriter:
    """Writes attributes.

    trees: the ports of each known tree; registry: the skills. The types of their ports tell texts
    from numbers.
    """

    trees: Mapping[str, Mapping[str, PortDeclaration]]
    registry: Registry
    _skills: dict[str, Any] = field(default_factory=dict)

    def of(self, node: Node) -> str:
        """All attributes of a node, always in the same order.

        Raises:
            CannotWrite: one has no spelling in XML.
        """
        return "".join(attribute(name, text) for name, text in self.pairs(node))

    def pairs(self, node: Node) -> list[tuple[str, str]]:
        """The name and the text of each attribute. Those that the file keeps come last.

        Raises:
            CannotWrite: one has no spelling in XML.
        """
        kept = node.attributes
        found = [("ID", node.target or "")] if node.type == SUBTREE else []
        if node.name is not None:
            found.append(("name", node.name))
        for name, value in node.ports.items():
            if xml_name(node, name) not in kept:
                found += self._port(node, name, value)
        found += [(XML_CONDITIONS[key], text) for key, text in node.conditions.items()]
        if node.note is not None:
            found.append((DESCRIPTION, node.note))
        if node.disabled:
            found.append((PREFIX + DISABLED, "true"))
        return [*(pair for pair in found if pair[0] not in kept), *kept.items()]

    def keep(self, node: Node, written: Mapping[str, str]) -> None:
        """Give the node those attributes of its element that would be written in another way.

        written: the attributes of the element; without those that say what the node is.
        """
        ours: dict[str, str] = {}
        for name, value in node.ports.items():
            with suppress(CannotWrite):
                ours.update(self._port(node, name, value))
        ours.update(self.pairs(replace(node, ports={})))
        node.attributes = {name: text for name, text in written.items() if ours.get(name) != text}

    def apart(self, node: Node) -> list[tuple[str, str]]:
        """Ports whose names cannot be attribute names, and their values in YAML."""
        return [
            (name, port_text(value))
            for name, value in node.ports.items()
            if not _has_attribute(node, name)
        ]

    def _port(self, node: Node, name: str, value: PortValue) -> list[tuple[str, str]]:
        if not _has_attribute(node, name):
            return []
        spec = NODES.get(node.type)
        shown = xml_name(node, name)
        type_ = self._type(node, name)
        if type_ is ScriptText:
            return [(shown, _script(node, value))]
        reserved = not shown or _is_reserved(shown)
        if name == AUTOREMAP and node.type == SUBTREE:
            reserved = False
        if spec is not None and name in spec.keys and isinstance(value, Literal):
            reserved = True  # in these attributes a bare word names a key
        text = None if reserved else plain(value, name, type_)
        if spec is not None and names_key(spec, name):
            text = _bare_key(value, text)
        if text is not None:
            return [(shown, text)]
        return [*_milliseconds(spec, name, value), (PREFIX + name, port_text(value))]

    def _type(self, node: Node, name: str) -> ValueType:
        spec = NODES.get(node.type)
        if spec is not None:
            return spec.ports[name].type if name in spec.ports else object
        if node.type == SUBTREE:
            declared = self.trees.get(node.target or "", {}).get(name)
            try:
                return object if declared is None else parse_type(declared.type_name)
            except KeyError:
                return object
        known: dict[str, Port] = self._skill(node.type)
        return known[name].type if name in known else object

    def _skill(self, name: str) -> dict[str, Port]:
        if name not in self._skills:
            try:
                self._skills[name] = dict(self.registry.skills[name].ports)
            except (KeyError, PluginError):
                self._skills[name] = {}
        found: dict[str, Port] = self._skills[name]
        return found


def xml_name(node: Node, port: str) -> str:
    """The name of a port's plain attribute; empty for a port that BehaviorTree.CPP lacks."""
    spec = NODES.get(node.type)
    return port if spec is None else spec.xml.get(port, port)


def _has_attribute(node: Node, name: str) -> bool:
    """Whether a port's name can be an attribute's name."""
    return is_name(name) and (node.type in NODES or name not in (DISABLED, NOTE))


def _bare_key(value: PortValue, text: str | None) -> str | None:
    """The bare name of the key: behind BehaviorTree.CPP's `{k}` is the name of another key."""
    if isinstance(value, Reference) and not value.fields:
        return f"@{value.key}" if value.scope is Scope.ROOT else value.key
    return text


def _script(node: Node, value: PortValue) -> str:
    if isinstance(value, Literal):
        return str(value.value)
    raise CannotWrite(f"a script of {node.type} that is a wire")


def _milliseconds(spec: NodeSpec | None, name: str, value: PortValue) -> list[tuple[str, str]]:
    """Our time in BehaviorTree.CPP's milliseconds too, if that is a whole number of them."""
    if spec is None or name != "duration" or "msec" not in spec.ports:
        return []
    seconds = value.value if isinstance(value, Literal) else None
    if isinstance(seconds, str):
        try:
            seconds = in_unit(seconds, "s")
        except UnitError:
            return []
    if isinstance(seconds, bool) or not isinstance(seconds, int | float):
        return []
    whole = round(seconds * 1000.0)
    exact = round(seconds * 1000.0, 6) == whole
    return [(spec.xml.get("msec", "msec"), str(whole))] if exact else []
