"""Examples of a skill in a tree, in YAML and in XML, made from its ports."""

from __future__ import annotations

from typing import Any

from momantu_bt.errors import PLUGIN_ERRORS
from momantu_bt.messages import ObjectClass
from momantu_bt.skill import Port, Skill
from momantu_bt.tree import model
from momantu_bt.tree.files.scalars import literal
from momantu_bt.tree.files.xml.attributes import port_attribute
from momantu_bt.tree.model import PortValue
from momantu_bt.values.kinds import (
    Choice,
    Enumeration,
    Items,
    Number,
    Record,
    Text,
    Truth,
    kind_of,
    without_none,
)

WIDEST = 76
"""The most characters of one line of an example."""
_NAMED = {
    "place": "table_a",
    "surface": "table_a",
    "tag": "dock",
    "named_pose": "home",
    "goal": "table_a",
    "spot": "table_a",
}
_QUANTITIES = {"m": "10 cm", "rad": "30 deg", "s": "2 s"}


class Wire(str):
    """A key without its `$`."""


def example_ports(skill: type[Skill]) -> dict[str, Any]:
    """A value or a Wire for each port that a tree must give, and a key for each output."""
    given = _rehearsed(skill)
    first = {group[0] for group in skill.one_of if not given.keys() & set(group)}
    found: dict[str, Any] = {}
    for port in skill.ports.values():
        if port.direction == "out":
            found[port.name] = Wire(port.name)
        elif port.name in given:
            found[port.name] = given[port.name]
        elif port.required or port.name in first:
            found[port.name] = _value(port)
    return found


def _rehearsed(skill: type[Skill]) -> dict[str, str | int | float]:
    """The plain inputs of its rehearsal; what differs from call to call is a temporary file."""
    try:
        inputs, again = (dict(skill.rehearsal(0)).get("inputs", {}) for _ in range(2))
    except PLUGIN_ERRORS:  # other people's code; `skills test` reports what it raises
        return {}
    return {
        name: value
        for name, value in inputs.items()
        if isinstance(value, str | int | float) and again.get(name) == value
    }


def yaml_example(name: str, skill: type[Skill]) -> str:
    """`dock: bay_a`, `grip: {thing: $seen}`, or one port a line if that is too long."""
    values = {port: _in_yaml(value) for port, value in example_ports(skill).items()}
    inputs = [port.name for port in skill.ports.values() if port.direction == "in"]
    if not values:
        return name
    if list(values) == inputs[:1] and not values[inputs[0]].startswith("{"):
        return f"{name}: {values[inputs[0]]}"
    line = f"{name}: {{{', '.join(f'{port}: {value}' for port, value in values.items())}}}"
    if len(line) <= WIDEST:
        return line
    return "\n".join([f"{name}:", *(f"  {port}: {value}" for port, value in values.items())])


def xml_example(name: str, skill: type[Skill]) -> str:
    """The same in XML: `{key}` is a key, plain text is text, and the rest is YAML with a prefix."""
    attributes = [
        port_attribute(port, _in_model(value), skill.ports[port].type).lstrip()
        for port, value in example_ports(skill).items()
    ]
    line = " ".join([f"<{name}", *attributes]) + "/>"
    if len(line) <= WIDEST:
        return line
    indent = " " * (len(name) + 2)
    return f"<{name} " + f"\n{indent}".join(attributes) + "/>"


def _in_model(value: Any) -> PortValue:
    return model.Reference(str(value)) if isinstance(value, Wire) else model.Literal(value)


def _in_yaml(value: Any) -> str:
    return f"${value}" if isinstance(value, Wire) else literal(value, flow=True)


def _value(port: Port) -> Any:
    named = _NAMED.get(port.names or "")
    if named is not None:
        listed = isinstance(without_none(kind_of(port.type))[0], Items)
        return [named] if listed else named
    match without_none(kind_of(port.type))[0]:
        case Choice(values=(first, *_)):
            return first
        case Enumeration(type=enum):
            return next(iter(enum)).value
        case Truth():
            return True
        case Number(type=number):
            return _number(port, number)
        case Text():
            return "text"
        case Record(type=kind) if kind is ObjectClass:
            return {"category": "can", "diameter": "66 mm", "height": "12 cm"}
        case _:
            return Wire(port.name)


def within(number: float, port: Port) -> float:
    """The number, moved into the port's range."""
    if port.least is not None and number < port.least:
        return port.least
    return port.most if port.most is not None and number > port.most else number


def _number(port: Port, type_: type) -> Any:
    """A quantity if the port has a unit and no range, or else a number in its range."""
    if not port.bounded and port.unit in _QUANTITIES and type_ is float:
        return _QUANTITIES[port.unit]
    value = type_(within(1, port))
    return value if port.unit is None or type_ is int else f"{value:g} {port.unit}"
