"""Tree files of BehaviorTree.CPP 3 as files of version 4.

The changes are those of BehaviorTree.CPP's page "Migrating from version 3.8 to 4.X".
"""

from __future__ import annotations

import re
from collections.abc import Callable

from lxml import etree

from momantu_bt.formats.places import Place
from momantu_bt.tree.catalogue import EXPLICIT, SUBTREE, XML_CONDITIONS
from momantu_bt.tree.files.syntax import parse

_RENAMED = {"SequenceStar": "SequenceWithMemory", "RetryUntilSuccesful": "RetryUntilSuccessful"}
_PORTS = {
    "success_threshold": "success_count",
    "failure_threshold": "failure_count",
    "threshold": "success_count",
}
"""Attributes of Parallel, and what they are called now."""
_CHECK = re.compile(r"BlackboardCheck(Int|Double|String|Bool)")
_WIRE = re.compile(r"\$?\{([^{}]+)\}")
_KEY = re.compile(r"@?[A-Za-z_]\w*")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")

Tell = Callable[[etree._Element, str], None]


def from_format_3(text: str, file: str) -> tuple[str, list[tuple[Place, str]]]:
    """A text of version 3 in version 4, and remarks on what means something else there.

    Raises:
        XmlSyntaxError: the text is not XML.
    """
    parse(text, file)  # reports what is wrong with the XML, in our words
    parser = etree.XMLParser(encoding="utf-8", resolve_entities=False, no_network=True)
    root = etree.fromstring(text.removeprefix("\ufeff").encode(), parser)
    remarks: list[tuple[Place, str]] = []

    def tell(element: etree._Element, message: str) -> None:
        place = Place(file, int(str(element.sourceline or 1)), 1)
        remarks.append((place, message))

    root.set("BTCPP_format", "4")
    for element in list(root.iter("*")):
        _convert(element, tell)
    return etree.tostring(root.getroottree(), encoding="unicode"), remarks


def _convert(element: etree._Element, tell: Tell) -> None:
    """Convert one element; those below it are converted on their own."""
    tag = str(element.tag)
    explicit = tag in EXPLICIT
    name = str(element.get("ID") or "") if explicit else tag
    for key, value in _texts(element).items():
        wire = _WIRE.fullmatch(value)
        if wire is not None and value.startswith("$"):
            element.set(key, f"{{{wire[1]}}}")
        if key in XML_CONDITIONS.values():
            tell(element, f"{key} had no meaning in format 3, and is a script in format 4")
    if name in _RENAMED:
        _rename(element, _RENAMED[name], explicit=explicit)
    elif tag == "SubTree" and not _in_model(element):
        _subtree(element, tell)
    elif tag == "SubTreePlus":
        element.tag = SUBTREE
        _move(element, "__autoremap", "_autoremap")
    elif name == "Parallel":
        for old, new in _PORTS.items():
            _move(element, old, new)
    elif (found := _CHECK.fullmatch(name)) is not None:
        _check(element, found[1], tell, explicit=explicit)
    elif name == "ManualSelector":
        tell(element, "ManualSelector is not among the nodes of format 4; nothing replaces it")


def _texts(element: etree._Element) -> dict[str, str]:
    return {str(key): str(value) for key, value in element.attrib.items()}


def _in_model(element: etree._Element) -> bool:
    parent = element.getparent()
    return parent is not None and parent.tag == "TreeNodesModel"


def _rename(element: etree._Element, name: str, *, explicit: bool) -> None:
    if explicit:
        element.set("ID", name)
    else:
        element.tag = name


def _move(element: etree._Element, old: str, new: str) -> None:
    if old in element.attrib and new not in element.attrib:
        element.set(new, _taken(element, old))


def _taken(element: etree._Element, name: str) -> str:
    """The text of an attribute, which the element loses; empty if it has none."""
    text = str(element.get(name) or "")
    if name in element.attrib:
        del element.attrib[name]
    return text


def _subtree(element: etree._Element, tell: Tell) -> None:
    """In format 3 the attributes of a SubTree name keys, without braces."""
    shared = _taken(element, "__shared_blackboard")
    if shared.lower() in ("true", "1"):
        element.set("_autoremap", "true")
        tell(element, "__shared_blackboard has become _autoremap: keys of one name are one key")
    for key, value in _texts(element).items():
        own = key in ("ID", "name") or key.startswith("_")
        if not own and not _WIRE.fullmatch(value):
            element.set(key, f"{{{value}}}")


def _check(element: etree._Element, kind: str, tell: Tell, *, explicit: bool) -> None:
    """`BlackboardCheckInt` and its like as a Precondition."""
    ports = _texts(element)
    sides = [_in_script(ports.get(name, ""), kind) for name in ("value_A", "value_B")]
    if None in sides:
        wrong = f"{ports.get('value_A', '')!r} and {ports.get('value_B', '')!r}"
        tell(element, f"BlackboardCheck{kind} of {wrong} has no script that compares them")
        return
    for name in ("value_A", "value_B", "return_on_mismatch"):
        _taken(element, name)
    _rename(element, "Precondition", explicit=explicit)
    element.set("if", f"{sides[0]} == {sides[1]}")
    element.set("else", ports.get("return_on_mismatch", "FAILURE"))
    tell(
        element,
        f"BlackboardCheck{kind} has become a Precondition, which asks before its child starts;"
        " format 3 asked at every tick",
    )


def _in_script(value: str, kind: str) -> str | None:
    """A value of a check in a script: a key, or a value of the kind; None if no script has it."""
    wire = _WIRE.fullmatch(value)
    if wire is not None:
        return wire[1] if _KEY.fullmatch(wire[1]) else None
    if kind == "String":
        return None if "'" in value else f"'{value}'"
    if kind == "Bool":
        return {"1": "true", "0": "false"}.get(value, value.lower() or None)
    return value if _NUMBER.fullmatch(value) else None
