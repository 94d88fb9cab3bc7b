"""The values of the blackboard that an XML tree file writes out: `<momantu:Values>`."""

from __future__ import annotations

from momantu_bt.formats.places import Place
from momantu_bt.formats.xml.elements import Element
from momantu_bt.tree.files.port_values import KEY
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.xml.values import flow_value
from momantu_bt.tree.model import Document, Literal
from momantu_bt.tree.problems import Problems


def read_values(document: Document, root: Element, problems: Problems) -> None:
    """Give the document its values, with their places and comments."""
    for section in root.children:
        if section.name == "Values" and section.space == OURS:
            for element in section.children:
                _value(document, element, problems)


def _value(document: Document, element: Element, problems: Problems) -> None:
    name = _key(document, element, problems)
    if name is None:
        return
    place = _text_place(element)
    found = flow_value(element.text.strip(), "", place, problems)
    if isinstance(found, Literal):
        document.values[name] = found
        document.value_places[name] = place
        document.value_comments[name] = element.comments
    elif found is not None:
        message = "one of the values is written out; a wire has no place here"
        hint = "write the value; in a text, $$ is a dollar"
        problems.error("wire-inside", place, message, hint)


def _key(document: Document, element: Element, problems: Problems) -> str | None:
    """The key to which an element gives a value; None if a problem was reported."""
    key = element.get("key")
    if element.name != "Value" or element.space != OURS or key is None:
        hint = 'write <momantu:Value key="name">value</momantu:Value>'
        message = f"<{element.said}> is not a value of the board"
        problems.error("unknown-key", element.place, message, hint)
        return None
    if not KEY.fullmatch(key.value):
        hint = "letters, digits and underscores, no digit first"
        message = f"{key.value!r} cannot be the name of a key"
        problems.error("bad-name", key.place, message, hint)
        return None
    if key.value in document.values:
        message = f"the key {key.value!r} stands here twice"
        problems.error("duplicate-key", key.place, message)
        return None
    return key.value


def _text_place(element: Element) -> Place:
    place, text = element.text_place, element.text.strip()
    if place is None:
        return element.place
    return Place(place.file, place.line, place.column, max(1, len(text.split("\n")[0])))
