"""The lines under `models:`, and metadata of trees."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.files.yaml.kept import (
    BEFORE,
    attribute_lines,
    comment_pairs,
    flow_pairs,
    mapping_lines,
)
from momantu_bt.tree.files.yaml.lines import above, beside
from momantu_bt.tree.model import Literal, MetadataFields, NodeModel, PortDeclaration

_PAD = " " * 4
_ITEM = " " * 6


def model_lines(models: Sequence[NodeModel], *, comments: bool) -> list[str]:
    """The lines under `models:`. comments: whether comments are values and not YAML's comments."""
    return [line for model in models for line in _model(model, comments)]


def _model(model: NodeModel, comments: bool) -> list[str]:
    remarks = () if comments else model.comments
    lines = [*above(remarks, "  "), f"  - {model.kind}: {_scalar(model.name)}{beside(remarks)}"]
    if model.editable is not None:
        lines.append(f"{_PAD}editable: {'true' if model.editable else 'false'}")
    lines += mapping_lines("attributes", dict(model.attributes), _PAD)
    pairs = comment_pairs(model.comments if comments else (), model.end_comments)
    lines += [f"{_PAD}{name}: {text}" for name, text in pairs]
    return lines + _inside(model, comments)


def _inside(model: NodeModel, comments: bool) -> list[str]:
    ports = [_port(port, comments) for port in model.ports]
    listed = ([f"{_PAD}ports:"] if ports else []) + [line for port in ports for line in port]
    fields = model.metadata[0] if len(model.metadata) == 1 else None
    if not model.metadata:
        return listed
    if fields is not None and not fields.comments and fields.at in (0, len(ports)):
        own = metadata_lines(fields, _PAD)
        return [*own, *listed] if fields.at == 0 else [*listed, *own]
    lines = [f"{_PAD}ports:"]
    for number in range(len(ports) + 1):
        for each in model.metadata:
            lines += _metadata_item(each) if min(each.at, len(ports)) == number else []
        lines += [line for port in ports[number : number + 1] for line in port]
    return lines


def metadata_lines(fields: MetadataFields, pad: str) -> list[str]:
    """`metadata:`, as a mapping where each entry is one name with one text."""
    names = [entry[0][0] for entry in fields.entries if len(entry) == 1]
    if fields.entries and len(set(names)) == len(fields.entries):
        return mapping_lines("metadata", {n: t for ((n, t),) in fields.entries}, pad)
    return [f"{pad}metadata: [{', '.join(_entries(fields))}]"]


def _entries(fields: MetadataFields) -> list[str]:
    return [f"{{{', '.join(_pairs(entry))}}}" for entry in fields.entries]


def _pairs(entry: Sequence[tuple[str, str]]) -> list[str]:
    return flow_pairs(dict(entry))


def _metadata_item(fields: MetadataFields) -> list[str]:
    (line,) = (f"{_ITEM}- metadata: [{', '.join(_entries(fields))}]",)
    by_number: dict[int, list[str]] = {}
    for number, text in fields.comments:
        by_number.setdefault(number, []).append(text)
    lists = (
        f"{number}: [{', '.join(scalar(t, flow=True, typed=False) for t in texts)}]"
        for number, texts in by_number.items()
    )
    return [line, f"{_ITEM}  {BEFORE}: {{{', '.join(lists)}}}"] if by_number else [line]


def _port(port: PortDeclaration, comments: bool) -> list[str]:
    remarks = () if comments else port.comments
    direction = "bidirectional" if port.tag == "bidirectional_port" else port.direction
    words = [f"{direction}: {_flow(port.name)}"]
    words += [f"type: {_flow(port.type_name)}"] if port.type_name else []
    if isinstance(port.default, Literal):
        words.append(f"default: {_flow(str(port.default.value))}")
    words += [f"doc: {_flow(port.doc)}"] if port.doc else []
    if port.attributes:
        words.append(f"attributes: {{{', '.join(flow_pairs(dict(port.attributes)))}}}")
    words += [f"{n}: {text}" for n, text in comment_pairs(port.comments if comments else ())]
    return [*above(remarks, _ITEM), f"{_ITEM}- {{{', '.join(words)}}}{beside(remarks)}"]


def _scalar(text: str) -> str:
    return scalar(text, typed=False)


def _flow(text: str) -> str:
    return scalar(text, flow=True, typed=False)


__all__ = ["attribute_lines", "metadata_lines", "model_lines"]
