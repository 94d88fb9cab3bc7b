"""A TreeNodesModel of skills, our own nodes and Nav2's, for the palette of editors like Groot2."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any

from lxml import etree

from momantu_bt.skill import MISSING, Port, Skill
from momantu_bt.tree.catalogue import NODES, Dialect, Kind, of_dialect, plugged_in
from momantu_bt.tree.files.xml.header import FORMAT
from momantu_bt.tree.files.xml.ports import CATCH, PREFIX
from momantu_bt.values.kinds import Choice, kind_of, without_none
from momantu_bt.values.types import label

_KINDS = {Kind.CONTROL: "Control", Kind.DECORATOR: "Decorator", Kind.LEAF: "Action"}
_TYPES = {"text": "std::string", "number": "double"}
"""Names that differ between BehaviorTree.CPP and us."""


def palette(skills: Mapping[str, type[Skill]]) -> str:
    """An XML file without trees: the models of skills, of our own nodes and of Nav2's.

    An editor includes or imports it, so that the nodes can be dragged into a tree.
    """
    root = etree.Element("root", BTCPP_format=FORMAT)
    section = etree.SubElement(root, "TreeNodesModel")
    for name, skill in sorted(skills.items()):
        _model(section, "Action", name, skill.ports, inspect.getdoc(skill) or "")
    for name in of_dialect(Dialect.OURS):
        spec = NODES[name]
        _model(section, _KINDS[spec.kind], PREFIX + name, spec.ports, spec.doc)
    for name in (*of_dialect(Dialect.NAV2), *plugged_in()):
        spec = NODES[name]
        _model(section, _KINDS[spec.kind], name, spec.ports, spec.doc)
    codes = Port("codes", "in", str, "codes of failures, `A | B` several, `any` the rest")
    doc = "What Recover or Handle do after these failures; without a child: try again."
    _model(section, "Decorator", PREFIX + CATCH, {"codes": codes}, doc)
    etree.indent(root, "  ")
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8").decode() + "\n"


def _model(
    section: etree._Element, kind: str, name: str, ports: Mapping[str, Port], doc: str
) -> None:
    model = etree.SubElement(section, kind, ID=name)
    for port in ports.values():
        direction = "output_port" if port.direction == "out" else "input_port"
        element = etree.SubElement(model, direction, name=port.name, type=_type(port))
        default = _default(port.default)
        if default is not None:
            element.set("default", default)
        element.text = _description(port)
    if doc:
        fields = etree.SubElement(model, "MetadataFields")
        etree.SubElement(fields, "Metadata", doc=" ".join(doc.split("\n\n")[0].split()))


def _type(port: Port) -> str:
    match without_none(kind_of(port.type)):
        case (Choice(values=values),) if all(isinstance(value, str) for value in values):
            return _TYPES["text"]
    name = label(port.type)
    return _TYPES.get(name, name)


def _default(value: Any) -> str | None:
    """A default as an attribute gives it; None if there is no default, or no attribute has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value) if isinstance(value, str | int | float) else None


def _description(port: Port) -> str:
    words = port.doc
    if port.unit is not None:
        words += f", in {port.unit}"
    if port.names is not None:
        words += f"; a {port.names.replace('_', ' ')}"
    if _type(port) == _TYPES["text"] and label(port.type) != "text":
        words += f"; {label(port.type)}"
    return words + ("; required" if port.direction == "in" and port.default is MISSING else "")
