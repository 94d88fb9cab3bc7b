"""Draw a document as an SVG picture, without any other program."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from lxml import etree

from momantu_bt.drawing.boxes import COLOURS, TreePicture, width_of
from momantu_bt.drawing.layout import (
    CELL,
    INDENT,
    LINE,
    MARGIN,
    PAD,
    SMALL_CELL,
    Lane,
    Outline,
    Placed,
    outlines,
)

_WIRE = "#b3541e"
_FONT = "'DejaVu Sans Mono', Menlo, Consolas, monospace"
_ROUND = {"control": "2", "subtree": "2"}
_SVG = "http://www.w3.org/2000/svg"
_NAMESPACES: Any = {None: _SVG}  # what lxml takes for the namespace without a prefix


def svg(trees: Sequence[TreePicture], *, wires: bool = True) -> str:
    """The picture as text. wires: draw them, dashed, with the key at each end."""
    drawn = outlines(trees, wires=wires)
    width = max(outline.width for outline in drawn)
    height = drawn[-1].y + drawn[-1].height + MARGIN
    root = etree.Element(f"{{{_SVG}}}svg", nsmap=_NAMESPACES)
    _set(root, width=width, height=height, viewBox=f"0 0 {_px(width)} {_px(height)}")
    _add(root, "title").text = trees[0].title
    _add(root, "rect", width=width, height=height, fill="#ffffff")
    page = _add(root, "g", font_family=_FONT, font_size="12", fill="#1b1b1b")
    for outline in drawn:
        _outline(page, outline)
    return etree.tostring(root, pretty_print=True, encoding="unicode")


def _outline(page: etree._Element, outline: Outline) -> None:
    group = _add(page, "g", id=f"tree-{outline.tree.name}")
    _text(group, outline.tree.title, MARGIN, outline.y + LINE, font_weight="bold")
    where = {placed.box.number: placed for placed in outline.boxes}
    for placed in outline.boxes:
        parent = where.get(placed.box.parent or 0)
        if parent is not None:
            _elbow(group, parent, placed)
    for placed in outline.boxes:
        _box(group, placed)
    wires = _add(group, "g", class_="wires", stroke=_WIRE, fill="none", stroke_dasharray="4 3")
    for lane in outline.lanes:
        _lane(wires, lane)


def _elbow(group: etree._Element, parent: Placed, child: Placed) -> None:
    x = parent.x + INDENT / 2
    way = (
        f"M{_px(x)} {_px(parent.y + parent.height)}V{_px(child.y + PAD + LINE / 2)}H{_px(child.x)}"
    )
    _add(group, "path", d=way, fill="none", stroke="#7a7a7a")


def _box(group: etree._Element, placed: Placed) -> None:
    box = placed.box
    for row, line in enumerate(reversed(placed.role)):
        y = placed.y - PAD / 2 - LINE * row
        _text(group, line, placed.x, y, small=True, fill="#555555")
    if box.kind == "subtree":
        group = _add(group, "a", href=f"#tree-{box.nodes[0].target}")
    _add(
        group,
        "rect",
        class_=box.kind,
        x=placed.x,
        y=placed.y,
        width=placed.width,
        height=placed.height,
        rx=_ROUND.get(box.kind, "8"),
        fill=COLOURS[box.kind],
        stroke="#666666",
    )
    for row, line in enumerate(placed.lines):
        y = placed.y + PAD / 2 + LINE * (row + 0.8)
        _text(group, line, placed.x + PAD, y, font_weight="normal" if row else "bold")


def _lane(group: etree._Element, lane: Lane) -> None:
    heights = [plug.y for plug in lane.plugs]
    way = f"M{_px(lane.x)} {_px(min(heights))}V{_px(max(heights))}"
    _add(group, "path", d=way)
    for plug in lane.plugs:
        y = _px(plug.y)
        _add(group, "path", d=f"M{_px(plug.x)} {y}H{_px(lane.x)}")
        shape = _add(group, "path", fill=_WIRE, stroke="none")
        x = plug.x
        if plug.writes:
            _set(shape, d=f"M{_px(lane.x - 3)} {y}a3 3 0 1 0 6 0a3 3 0 1 0 -6 0z")
        else:
            _set(shape, d=f"M{_px(x)} {y}l6 -3v6z")
        _text(group, lane.key, x + 8, plug.y - 2, small=True, fill=_WIRE, stroke="none")


def _text(
    parent: etree._Element, text: str, x: float, y: float, *, small: bool = False, **look: str
) -> None:
    """One line; it takes the room that the layout gave it in any font."""
    width = width_of(text) * (SMALL_CELL if small else CELL)
    element = _add(parent, "text", x=x, y=y, textLength=width, **look)
    if small:
        _set(element, font_size="10")
    element.set("lengthAdjust", "spacingAndGlyphs")
    element.set("{http://www.w3.org/XML/1998/namespace}space", "preserve")
    element.text = text


def _add(parent: etree._Element, tag: str, **attributes: str | float) -> etree._Element:
    element = etree.SubElement(parent, f"{{{_SVG}}}{tag}")
    _set(element, **attributes)
    return element


def _set(element: etree._Element, **attributes: str | float) -> None:
    for name, value in attributes.items():
        plain = name.rstrip("_")
        key = plain if plain in ("viewBox", "textLength") else plain.replace("_", "-")
        element.set(key, value if isinstance(value, str) else _px(value))


def _px(length: float) -> str:
    return f"{length:.1f}".removesuffix(".0")
