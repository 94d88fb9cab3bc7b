"""The first difference between two XML texts: elements, attributes, texts, comments, order."""

from __future__ import annotations

from itertools import zip_longest

from lxml import etree


def first_difference(one: str, two: str) -> tuple[int, str] | None:
    """The line in the first text of the first difference, and what it is; None if they are equal.

    White space at the ends of texts and comments, the order of attributes, and processing
    instructions do not count. Both texts are valid XML.
    """
    first, second = _parsed(one), _parsed(two)
    outside = _outside(first), _outside(second)
    if outside[0] != outside[1]:
        return _line(first), "comments outside of the root element"
    waiting = [(first, second)]
    while waiting:
        left, right = waiting.pop()
        found = _own_difference(left, right)
        if found is not None:
            return _line(left), found
        below = list(zip_longest(left, right))
        waiting.extend((a, b) for a, b in reversed(below))
    return None


def _own_difference(left: etree._Element, right: etree._Element) -> str | None:
    """What differs between two elements or comments, leaving aside what is below them."""
    said = _said(left)
    if left.tag != right.tag:
        return f"{said} would become {_said(right)}"
    if _stripped(left.text) != _stripped(right.text):
        return f"the text of {said}"
    if _stripped(left.tail) != _stripped(right.tail):
        return f"the text after {said}"
    ours: dict[str, str] = {str(key): str(value) for key, value in left.attrib.items()}
    theirs: dict[str, str] = {str(key): str(value) for key, value in right.attrib.items()}
    name = next((n for n in {**ours, **theirs} if ours.get(n) != theirs.get(n)), None)
    if name is not None:
        return f"the attribute {etree.QName(name).localname!r} of {said}"
    if len(left) != len(right):
        kinds = zip_longest((child.tag for child in left), (child.tag for child in right))
        at = next((number for number, (a, b) in enumerate(kinds) if a != b), 0)
        return f"what is inside {said}, at its part {at + 1}"
    return None


def _line(element: etree._Element) -> int:
    return int(str(element.sourceline or 1))


def _parsed(text: str) -> etree._Element:
    parser = etree.XMLParser(
        encoding="utf-8", resolve_entities=False, no_network=True, load_dtd=False, remove_pis=True
    )
    text = text.removeprefix("\ufeff")
    return etree.fromstring(text.encode("utf-8", "surrogatepass"), parser)


def _outside(root: etree._Element) -> list[list[str]]:
    """The comments before and after the root element."""
    before = [_stripped(each.text) for each in root.itersiblings(preceding=True)]
    return [before, [_stripped(each.text) for each in root.itersiblings()]]


def _said(element: etree._Element) -> str:
    if not isinstance(element.tag, str):
        return "a comment"
    return f"<{etree.QName(element).localname}>"


def _stripped(text: str | None) -> str:
    return (text or "").strip()
