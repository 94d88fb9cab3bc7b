"""Models of nodes as the elements of a `<TreeNodesModel>`."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.files.scalars import CannotWrite, port_text
from momantu_bt.tree.files.xml.attributes import is_name, plain
from momantu_bt.tree.files.xml.ports import PREFIX
from momantu_bt.tree.files.xml.text import above, attribute, beside, escaped
from momantu_bt.tree.model import Literal, MetadataFields, NodeModel, PortDeclaration, Tree
from momantu_bt.values.types import parse_type

_STEP = "  "
_TAGS = {"in": "input_port", "out": "output_port", "inout": "inout_port"}


def model_lines(model: NodeModel) -> list[str]:
    """A model that is kept as its file has it."""
    ports = [_kept_port(port) for port in model.ports]
    start = f"<{model.kind}{attribute('ID', model.name)}"
    if model.editable is not None:
        start += attribute("editable", "true" if model.editable else "false")
    start += "".join(attribute(name, text) for name, text in model.attributes)
    inside = [*_inside(ports, model.metadata), *above(model.end_comments, _STEP * 3, every=True)]
    return _model(start, inside, model.comments)


def tree_model_lines(tree: Tree) -> list[str]:
    """The model of a tree: its ports, and its metadata."""
    in_groups = sorted(tree.ports.values(), key=lambda port: [*_TAGS].index(port.direction))
    ports = [_tree_port(port) for port in in_groups]
    return _model(f"<{SUBTREE}{attribute('ID', tree.name)}", _inside(ports, tree.metadata), ())


def _inside(ports: Sequence[list[str]], metadata: Sequence[MetadataFields]) -> list[str]:
    """The lines of ports and metadata, each where it belongs."""
    lines: list[str] = []
    for number in range(len(ports) + 1):
        for fields in metadata:
            lines += _metadata(fields) if min(fields.at, len(ports)) == number else []
        for port in ports[number : number + 1]:
            lines += port
    return lines


def _kept_port(port: PortDeclaration) -> list[str]:
    words = attribute("name", port.name)
    words += attribute("type", port.type_name) if port.type_name else ""
    if isinstance(port.default, Literal):
        words += attribute("default", str(port.default.value))
    words += "".join(attribute(name, text) for name, text in port.attributes)
    return [*above(port.comments, _STEP * 3), _port(port, words) + beside(port.comments)]


def _model(start: str, inside: Sequence[str], comments: Sequence[str]) -> list[str]:
    name = start[1:].partition(" ")[0]
    pad, remark = _STEP * 2, beside(comments)
    if not inside:
        return [*above(comments, pad), f"{pad}{start}/>{remark}"]
    return [*above(comments, pad), f"{pad}{start}>{remark}", *inside, f"{pad}</{name}>"]


def _metadata(fields: MetadataFields) -> list[str]:
    lines: list[str] = []
    for number in range(len(fields.entries) + 1):
        lines += above(_before(fields, number), _STEP * 4)
        entries = fields.entries[number : number + 1]
        lines += [f"{_STEP * 4}<Metadata{_pairs(each)}/>" for each in entries]
    first = above(_before(fields, -1), _STEP * 3)
    if not lines:
        return [*first, f"{_STEP * 3}<MetadataFields/>"]
    return [*first, f"{_STEP * 3}<MetadataFields>", *lines, f"{_STEP * 3}</MetadataFields>"]


def _before(fields: MetadataFields, number: int) -> list[str]:
    return [text for at, text in fields.comments if at == number]


def _pairs(pairs: Sequence[tuple[str, str]]) -> str:
    wrong = next((name for name, _ in pairs if not is_name(name)), None)
    if wrong is not None:
        raise CannotWrite(f"{wrong!r} cannot be the name of an attribute")
    return "".join(attribute(name, value) for name, value in pairs)


def _tree_port(port: PortDeclaration) -> list[str]:
    words = attribute("name", port.name)
    shown = port.written_type or port.type_name
    if shown != "any":
        words += attribute("type", shown)
    if port.default is not None:
        text = plain(port.default, port.name, _type(port.type_name))
        ours = port_text(port.default)
        words += attribute(f"{PREFIX}default", ours) if text is None else attribute("default", text)
    comments = [*above(port.comments, _STEP * 3)]
    exact = port.doc != " ".join(port.doc.split())
    return [*comments, _port(port, words, exact=exact) + beside(port.comments)]


def _type(name: str) -> object:
    try:
        return parse_type(name)
    except KeyError:
        return object


def _port(port: PortDeclaration, words: str, *, exact: bool = False) -> str:
    """A port's element. exact: its text needs an attribute, in which white space counts."""
    tag = port.tag or _TAGS[port.direction]
    if port.doc and (exact or port.doc != port.doc.strip()):
        words, inside = words + attribute(f"{PREFIX}doc", port.doc), ""
    else:
        inside = escaped(port.doc, between=True)
    return _STEP * 3 + f"<{tag}{words}" + (f">{inside}</{tag}>" if inside else "/>")
