"""What a built-in node is: its canonical type, spelling in YAML, ports and children."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from momantu_bt.skill import MISSING, Port


class Kind(StrEnum):
    """What a built-in node is to its parent and to its children."""

    CONTROL = "control"
    DECORATOR = "decorator"
    LEAF = "leaf"


@dataclass(frozen=True, slots=True)
class NodeSpec:
    """One built-in node.

    yaml: the spellings, preferred first. first: the port that a scalar in YAML means.
    modifier: the YAML spelling may stand beside a node key. children: least and most (None: any).
    positions: what each child is, where they have names of their own in YAML (if, then, else).
    handlers: takes `catch:`. xml: attribute names of BehaviorTree.CPP for ports named otherwise;
    empty for a port that it does not have. one_of: groups of inputs, exactly one of which is given.
    keys: ports that mean a key and not its value; in XML its bare name will do.
    may_be_empty: inputs whose key need not hold a value. item: the output that holds what the
    child of a loop works on, and the input where it comes from. switch: how many cases it has.
    """

    type: str
    yaml: tuple[str, ...]
    kind: Kind
    doc: str
    ports: Mapping[str, Port] = field(default_factory=dict)
    first: str | None = None
    children: tuple[int, int | None] = (0, 0)
    positions: tuple[str, ...] = ()
    modifier: bool = False
    handlers: bool = False
    concurrent: bool = False
    xml: Mapping[str, str] = field(default_factory=dict)
    one_of: tuple[tuple[str, ...], ...] = ()
    keys: tuple[str, ...] = ()
    may_be_empty: tuple[str, ...] = ()
    item: tuple[str, str] | None = None
    switch: int = 0


def by_name(*ports: Port) -> dict[str, Port]:
    """Ports as `NodeSpec.ports` holds them."""
    return {port.name: port for port in ports}


def output_port(name: str, type_: Any, doc: str, default: Any = MISSING) -> Port:
    """An output of a built-in node; with the default None it need not be wired."""
    return Port(name, "out", type_, doc, default)


def input_port(
    name: str,
    type_: Any,
    doc: str,
    default: Any = MISSING,
    unit: str | None = None,
    *,
    least: float | None = None,
    most: float | None = None,
    endless: bool = False,
) -> Port:
    """An input of a built-in node. least, most, endless: see `Port`."""
    return Port(name, "in", type_, doc, default, unit, least=least, most=most, endless=endless)


def time_ports(doc: str) -> tuple[Port, Port]:
    """A time in either spelling, ours and BehaviorTree.CPP's; exactly one is given."""
    return (
        input_port("duration", float, doc, None, unit="s", least=0),
        input_port("msec", int, f"{doc}, in milliseconds", None, least=0),
    )


TIME = (("duration", "msec"),)
"""`NodeSpec.one_of` of a node with `time_ports`."""


def control(
    type_: str,
    yaml: str,
    doc: str,
    *ports: Port,
    least: int = 1,
    most: int | None = None,
    concurrent: bool = False,
    keys: tuple[str, ...] = (),
) -> NodeSpec:
    """A node that decides which of its children run."""
    return NodeSpec(
        type_,
        (yaml,),
        Kind.CONTROL,
        doc,
        by_name(*ports),
        children=(least, most),
        concurrent=concurrent,
        keys=keys,
    )


def decorator(
    type_: str,
    yaml: str,
    doc: str,
    *ports: Port,
    modifier: bool = True,
    xml: Mapping[str, str] | None = None,
    one_of: tuple[tuple[str, ...], ...] = (),
    keys: tuple[str, ...] = (),
    may_be_empty: tuple[str, ...] = (),
    item: tuple[str, str] | None = None,
) -> NodeSpec:
    """A node around one child; its first port is what a bare value means."""
    return NodeSpec(
        type_,
        (yaml,),
        Kind.DECORATOR,
        doc,
        by_name(*ports),
        first=ports[0].name if ports else None,
        children=(1, 1),
        positions=("child",),
        modifier=modifier,
        xml=xml or {},
        one_of=one_of,
        keys=keys,
        may_be_empty=may_be_empty,
        item=item,
    )


def leaf(
    type_: str,
    yaml: tuple[str, ...],
    doc: str,
    *ports: Port,
    xml: Mapping[str, str] | None = None,
    one_of: tuple[tuple[str, ...], ...] = (),
    keys: tuple[str, ...] = (),
    may_be_empty: tuple[str, ...] = (),
) -> NodeSpec:
    """A node without children; its first port is what a bare value means."""
    return NodeSpec(
        type_,
        yaml,
        Kind.LEAF,
        doc,
        by_name(*ports),
        first=ports[0].name if ports else None,
        xml=xml or {},
        one_of=one_of,
        keys=keys,
        may_be_empty=may_be_empty,
    )
