"""`models:` in YAML: what an XML file says of nodes in its TreeNodesModel, kept as it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.files.xml.models import declared_ports
from momantu_bt.tree.files.yaml.kept import (
    BEFORE,
    BESIDE,
    INSIDE,
    attributes_of,
    comments_of,
    text_list,
)
from momantu_bt.tree.model import (
    Document,
    Literal,
    MetadataFields,
    NodeModel,
    PortDeclaration,
)
from momantu_bt.tree.problems import Problems

KINDS = ("Action", "Condition", "Control", "Decorator", SUBTREE)
"""Kinds of nodes in a palette. The kind is the key that names a model's node."""
DIRECTIONS = ("in", "out", "inout", "bidirectional")
"""Directions of a port; `bidirectional` is another word for `inout`."""
_COMMENTS = (BEFORE, BESIDE, INSIDE)
_HINT = "such as `- {Action: Name, ports: [{in: goal, type: Pose}]}`"


def read_models(raw: Raw, problems: Problems) -> tuple[NodeModel, ...]:
    """The models of a file. Models that are written wrongly are reported and left out."""
    if not isinstance(raw, Items):
        if not (isinstance(raw, Scalar) and raw.value is None):
            problems.error("wrong-value", raw.place, "`models` is a list of nodes", _HINT)
        return ()
    found = (_model(item, problems) for item in raw.items)
    return tuple(model for model in found if model is not None)


def give_ports(document: Document, problems: Problems) -> None:
    """Give trees the ports that their models declare."""
    with problems.keeping():
        for model in document.models:
            tree = document.trees.get(model.name) if model.kind == SUBTREE else None
            if tree is not None and not tree.ports:
                tree.ports, tree.open = declared_ports(model, problems), False


def read_metadata(raw: Raw, problems: Problems) -> tuple[tuple[tuple[str, str], ...], ...]:
    """The entries of metadata: a mapping, or a list of mappings."""
    if isinstance(raw, Scalar) and raw.value is None:
        return ()
    listed: list[Raw] = raw.items if isinstance(raw, Items) else []
    if isinstance(raw, Entries):
        listed = [Entries([pair], raw.place) for pair in raw.entries]
    elif not isinstance(raw, Items):
        problems.error("wrong-value", raw.place, "metadata are names and texts", _HINT)
    key = Scalar("attributes", "attributes", False, raw.place)
    return tuple(
        tuple((each.said, each.value) for each in attributes_of([(key, entry)], problems))
        for entry in listed
    )


def _model(raw: Raw, problems: Problems) -> NodeModel | None:
    known = (*KINDS, "editable", "ports", "metadata", "attributes", *_COMMENTS)
    having = _fields(raw, known, problems)
    kind = next((kind for kind in KINDS if kind in having), None)
    if kind is None or not isinstance(having[kind], Scalar):
        problems.error("wrong-value", raw.place, "a model names its node", _HINT)
        return None
    editable = _flag(having.get("editable"))
    ports, metadata = _inside(having, problems)
    if editable is _WRONG or not isinstance(having.get("ports"), Items | None):
        problems.error("wrong-value", raw.place, "this is not a model of a node", _HINT)
        return None
    return NodeModel(
        _text(having[kind]),
        kind,
        ports,
        editable,
        metadata,
        place=having[kind].place,
        attributes=_attributes(having, problems),
        comments=comments_of(having),
        end_comments=tuple(text_list(having.get(INSIDE))),
    )


_WRONG = object()


def _flag(raw: Raw | None) -> Any:
    if raw is None:
        return None
    return raw.value if isinstance(raw, Scalar) and isinstance(raw.value, bool) else _WRONG


def _inside(
    having: dict[str, Raw], problems: Problems
) -> tuple[tuple[PortDeclaration, ...], tuple[MetadataFields, ...]]:
    """Ports, and metadata before, between or after them."""
    listed = having.get("ports")
    ports: list[PortDeclaration] = []
    metadata: list[MetadataFields] = []
    for item in listed.items if isinstance(listed, Items) else []:
        if isinstance(item, Entries) and item.entries and item.entries[0][0].text == "metadata":
            metadata.append(_metadata(item.entries[0][1], item, len(ports), problems))
        elif (port := _port(item, problems)) is not None:
            ports.append(port)
    if "metadata" in having:
        first = next(name for name in having if name in ("ports", "metadata")) == "metadata"
        at = 0 if first else len(ports)
        metadata.append(_metadata(having["metadata"], None, at, problems))
    return tuple(ports), tuple(metadata)


def _metadata(raw: Raw, item: Entries | None, at: int, problems: Problems) -> MetadataFields:
    comments = []
    for key, value in item.entries[1:] if item is not None else ():
        if key.text == BEFORE and isinstance(value, Entries):
            for number, texts in value.entries:
                place = int(number.text) if number.text.lstrip("-").isdigit() else 0
                comments += [(place, text) for text in text_list(texts)]
    return MetadataFields(read_metadata(raw, problems), at, tuple(comments))


def _port(raw: Raw, problems: Problems) -> PortDeclaration | None:
    known = (*DIRECTIONS, "type", "default", "doc", "attributes", *_COMMENTS)
    having = _fields(raw, known, problems)
    direction = next((name for name in DIRECTIONS if name in having), None)
    if direction is None:
        problems.error("wrong-value", raw.place, "a port of a model has a direction", _HINT)
        return None
    default = Literal(_text(having["default"])) if "default" in having else None
    type_name, doc = (_text(having[key]) if key in having else "" for key in ("type", "doc"))
    name, place = _text(having[direction]), having[direction].place
    both = direction == "bidirectional"
    return PortDeclaration(
        name,
        "inout" if both else direction,
        type_name,
        place,
        default,
        doc,
        comments=comments_of(having),
        tag="bidirectional_port" if both else "",
        attributes=_attributes(having, problems),
    )


def _attributes(having: dict[str, Raw], problems: Problems) -> tuple[tuple[str, str], ...]:
    raw = having.get("attributes")
    if raw is None:
        return ()
    key = Scalar("attributes", "attributes", False, raw.place)
    return tuple((each.said, each.value) for each in attributes_of([(key, raw)], problems))


def _fields(raw: Raw, known: Sequence[str], problems: Problems) -> dict[str, Raw]:
    entries = raw.entries if isinstance(raw, Entries) else []
    for key, _ in entries:
        if key.text not in known:
            hint = valid_names(key.text, known, "keys")
            problems.error("unknown-key", key.place, f"a model has no {key.text!r}", hint)
    return {key.text: value for key, value in entries if key.text in known}


def _text(raw: Raw) -> str:
    return raw.text if isinstance(raw, Scalar) else ""


def add_comment(document: Document, model: int, port: int | None, text: str) -> None:
    """Give a comment to a model, or to one of its ports."""
    models = list(document.models)
    found = models[model]
    if port is None:
        models[model] = replace(found, comments=(*found.comments, text))
    else:
        ports = list(found.ports)
        ports[port] = replace(ports[port], comments=(*ports[port].comments, text))
        models[model] = replace(found, ports=tuple(ports))
    document.models = tuple(models)
