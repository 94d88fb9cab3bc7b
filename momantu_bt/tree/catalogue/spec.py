"""What a kind of node declares: its names, ports and children, how it is checked and shown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, NamedTuple, TypedDict, Unpack

from momantu_bt.skill import MISSING, Port
from momantu_bt.tree.catalogue.codes import CodeFlow, passed_on
from momantu_bt.tree.catalogue.flow import Flow, as_written, unsure
from momantu_bt.tree.model import Node


class Kind(StrEnum):
    """The kind of a node: control node, decorator or leaf."""

    CONTROL = "control"
    DECORATOR = "decorator"
    LEAF = "leaf"


class Dialect(StrEnum):
    """Whose trees know a node."""

    BTCPP = "btcpp"
    """BehaviorTree.CPP."""
    NAV2 = "nav2"
    """Nav2's plug-ins for it."""
    OURS = "momantu"
    """Ours alone; in XML it stands in our namespace."""


class Scripts(StrEnum):
    """What the checker does with scripts at a node's ports."""

    ASKED = "asked"
    """They are read before the node runs; what they write is not counted on."""
    RUN = "run"
    """The node runs them: what they write is known after it."""
    OWN = "own"
    """The node's flow reads them itself."""


class Objection(NamedTuple):
    """A value that a node cannot have. port: whose value."""

    port: str
    message: str
    hint: str = ""


@dataclass(frozen=True, slots=True)
class NodeSpec:
    """One kind of node.

    type: canonical name, the tag in XML. yaml: the spellings, preferred first. first: the port
    that a scalar in YAML means. modifier: the YAML spelling may stand beside a node key. children:
    least and most (None: any). positions: what each child is, where they have names of their own
    in YAML (if, then, else). handlers: takes `catch:`; tries_again: a handler may be `again`. xml:
    attribute names of BehaviorTree.CPP for ports named otherwise; empty for a port that it does not
    have. switch: how many cases it has.

    one_of: groups of inputs, exactly one of which is given. keys: ports that mean a key and not its
    value; in XML its bare name will do. may_be_empty: inputs whose key need not hold a value.
    item: the output that holds what the child of a loop works on, and the input where it comes
    from. copies: outputs that get the value of an input. removes: the port whose key loses its
    value. scripts: what becomes of scripts at ports. objection: what is wrong with its values.

    concurrent: children run side by side. in_turn: children are asked once, one after the other.
    condition: a leaf that asks something and ends at once. retries: it runs its first child again
    when that has failed. flow: how what is known of keys passes through it; the default counts on
    nothing that its children write. codes: which failure codes come out of it.

    title: what it is called in words, the spelling unless given. port_words: its ports in words.
    around: a decorator in the line of its child. roles: what each child is, in words.
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
    tries_again: bool = False
    dialect: Dialect = Dialect.BTCPP
    xml: Mapping[str, str] = field(default_factory=dict)
    switch: int = 0
    one_of: tuple[tuple[str, ...], ...] = ()
    keys: tuple[str, ...] = ()
    may_be_empty: tuple[str, ...] = ()
    item: tuple[str, str] | None = None
    copies: Mapping[str, str] = field(default_factory=dict)
    removes: str | None = None
    scripts: Scripts = Scripts.ASKED
    objection: Callable[[Node], Objection | None] | None = None
    concurrent: bool = False
    in_turn: bool = False
    condition: bool = False
    retries: bool = False
    flow: Flow = unsure
    codes: CodeFlow = passed_on
    title: str | None = None
    port_words: Callable[[Node], list[str]] | None = None
    around: Callable[[Node], str] | None = None
    roles: Callable[[Node], list[str]] | None = None


class Further(TypedDict, total=False):
    """Further arguments of `control`, `decorator` and `leaf`; see `NodeSpec`."""

    first: str | None
    children: tuple[int, int | None]
    positions: tuple[str, ...]
    modifier: bool
    handlers: bool
    tries_again: bool
    dialect: Dialect
    xml: Mapping[str, str]
    switch: int
    one_of: tuple[tuple[str, ...], ...]
    keys: tuple[str, ...]
    may_be_empty: tuple[str, ...]
    item: tuple[str, str] | None
    copies: Mapping[str, str]
    removes: str | None
    scripts: Scripts
    objection: Callable[[Node], Objection | None] | None
    concurrent: bool
    in_turn: bool
    condition: bool
    retries: bool
    flow: Flow
    codes: CodeFlow
    title: str | None
    port_words: Callable[[Node], list[str]] | None
    around: Callable[[Node], str] | None
    roles: Callable[[Node], list[str]] | None


def control(type_: str, yaml: str, doc: str, *ports: Port, **further: Unpack[Further]) -> NodeSpec:
    """A node that decides which of its children run; at least one unless `children` says more."""
    further.setdefault("children", (1, None))
    return NodeSpec(type_, (yaml,), Kind.CONTROL, doc, by_name(*ports), **further)


def decorator(
    type_: str, yaml: str, doc: str, *ports: Port, **further: Unpack[Further]
) -> NodeSpec:
    """A node around one child, which may be written beside it; a bare value is its first port."""
    further.setdefault("modifier", True)
    further.setdefault("positions", ("child",))
    further.setdefault("children", (1, 1))
    further.setdefault("first", ports[0].name if ports else None)
    return NodeSpec(type_, (yaml,), Kind.DECORATOR, doc, by_name(*ports), **further)


def leaf(
    type_: str,
    yaml: str | tuple[str, ...],
    doc: str,
    *ports: Port,
    **further: Unpack[Further],
) -> NodeSpec:
    """A node without children; a bare value goes to its first port."""
    spellings = (yaml,) if isinstance(yaml, str) else yaml
    further.setdefault("first", ports[0].name if ports else None)
    further.setdefault("flow", as_written)
    return NodeSpec(type_, spellings, Kind.LEAF, doc, by_name(*ports), **further)


def by_name(*ports: Port) -> dict[str, Port]:
    """Ports as `NodeSpec.ports` holds them."""
    return {port.name: port for port in ports}


def output_port(name: str, type_: Any, doc: str, default: Any = MISSING) -> Port:
    """An output of a node; with the default None it need not be wired."""
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
    """An input of a node. least, most, endless: see `Port`."""
    return Port(name, "in", type_, doc, default, unit, least=least, most=most, endless=endless)


def time_ports(doc: str) -> tuple[Port, Port]:
    """A time in either spelling, ours and BehaviorTree.CPP's; exactly one is given."""
    return (
        input_port("duration", float, doc, None, unit="s", least=0),
        input_port("msec", int, f"{doc}, in milliseconds", None, least=0),
    )


TIME = (("duration", "msec"),)
"""`NodeSpec.one_of` of a node with `time_ports`."""
