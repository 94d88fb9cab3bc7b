"""The declared ports of a tree in YAML: `inputs:`, `outputs:`, `inouts:`."""

from __future__ import annotations

from momantu_bt.formats.names import nearest
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.files.port_values import drop_duplicates, is_key, mapping, port_value, words
from momantu_bt.tree.files.yaml.words import PORTS
from momantu_bt.tree.model import Literal, PortDeclaration, Reference, Template, Tree
from momantu_bt.tree.problems import Problems
from momantu_bt.values.cpp_types import our_type

_DECLARATION = ("type", "default", "doc")


def read_declarations(tree: Tree, raw: Raw, name: str, problems: Problems) -> None:
    """Give the tree its ports of one direction. name: the key above them."""
    direction = PORTS[name]
    if isinstance(raw, Items):
        raw = _untyped(raw, name, problems)
    for key, value in mapping(raw, name, "name: type", problems):
        if not is_key(key, problems):
            continue
        if key.text in tree.ports and tree.ports[key.text].direction != direction:
            message = f"{key.text!r} is an input or output already"
            hint = "a key that comes in and goes out stands under `inouts:`"
            problems.error("duplicate-key", key.place, message, hint)
        found = _declaration(key, value, direction, problems)
        if found is not None:
            tree.ports[key.text] = found


def _untyped(raw: Items, name: str, problems: Problems) -> Entries:
    """Read `[a, b]` as `{a: any, b: any}`."""
    entries: list[tuple[Scalar, Raw]] = []
    for item in raw.items:
        if isinstance(item, Scalar):
            entries.append((item, Scalar("any", "any", False, item.place)))
        else:
            hint = f"write `{name}: {{name: type}}`"
            problems.error("wrong-value", item.place, f"`{name}` lists names", hint)
    return Entries(entries, raw.place)


def _declaration(
    key: Scalar, raw: Raw, direction: str, problems: Problems
) -> PortDeclaration | None:
    if isinstance(raw, Scalar) and isinstance(raw.value, str):
        ours, written = _type(raw.value)
        return PortDeclaration(key.text, direction, ours, raw.place, written_type=written)
    if not isinstance(raw, Entries):
        hint = "write `name: text` or `name: {type: text, default: …}`"
        problems.error("wrong-value", raw.place, f"{key.text!r} needs a type", hint)
        return None
    drop_duplicates(raw, problems)
    having = {k.text: v for k, v in raw.entries}
    for name, _ in raw.entries:
        if name.text not in _DECLARATION:
            near = nearest(name.text, _DECLARATION)
            hint = f"did you mean {near}?" if near else f"keys: {', '.join(_DECLARATION)}"
            message = f"an input or output has no {name.text!r}"
            problems.error("unknown-key", name.place, message, hint)
    type_ = having.get("type")
    if type_ is not None and not isinstance(type_, Scalar):
        hint = "such as `type: text` or `type: list of int`"
        problems.error("wrong-value", type_.place, "`type` is the name of a type", hint)
    default = having.get("default")
    ours, written = _type(type_.text if isinstance(type_, Scalar) else "any")
    return PortDeclaration(
        key.text,
        direction,
        ours,
        type_.place if type_ is not None else raw.place,
        None if default is None else _default(default, problems),
        words(having["doc"], problems, "`doc`") if "doc" in having else "",
        written_type=written,
    )


def _type(name: str) -> tuple[str, str]:
    """Our name of a type, and the name that is written if it is one of C++."""
    ours = our_type(name)
    known = ours != name and (ours != "any" or "::" in name)
    return (ours, name) if known else (name, "")


def _default(raw: Raw, problems: Problems) -> Literal | Reference | None:
    found = port_value(raw, "", problems)
    if isinstance(found, Template) or (isinstance(found, Reference) and found.fields):
        message = "a default is a value, or one key of whoever runs the tree"
        problems.error("wire-inside", raw.place, message, "write the value, or $key")
        return None
    return found
