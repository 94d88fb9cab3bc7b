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
    """The library that a node comes from."""

    BTCPP = "btcpp"
    """BehaviorTree.CPP."""
    NAV2 = "nav2"
    """Nav2's plug-ins for BehaviorTree.CPP."""
    OURS = "momantu"
    """Momantu's own nodes; in XML they are in Momantu's namespace."""


class Scripts(StrEnum):
    """How the checker treats the scripts at a node's ports."""

    ASKED = "asked"
    """Their reads are checked; nothing that they write is relied on."""
    RUN = "run"
    """The node runs them, so the keys that they write are known after it."""
    OWN = "own"
    """The node's `flow` handles them itself."""


class Objection(NamedTuple):
    """What is wrong with the value of a port."""

    port: str
    message: str
    hint: str = ""


@dataclass(frozen=True, slots=True)
class NodeSpec:
    """One kind of node.

    Names and files:
        type: the canonical name, which is the tag in XML. yaml: its names in YAML, the preferred
        one first. first: the port that a bare value in YAML sets. modifier: in YAML it may also be
        a key beside another node. children: fewest and most (None: no limit). positions: YAML keys
        of the children, for nodes whose children have names (if, then, else). handlers: it takes
        `catch:`. tries_again: a handler may be `again`. xml: attribute names in XML for ports that
        BehaviorTree.CPP names differently; empty for a port that it lacks. switch: number of cases.

    For the checker:
        one_of: groups of inputs; a tree gives exactly one input of each. keys: ports that take a
        key itself instead of its value; in XML the bare name is enough. may_be_empty: inputs whose
        key may have no value. item: of a loop, the output with the current item and the input with
        the list. copies: for each such output, the input whose value it gets. choices: for outputs,
        the input that lists the possible values. removes: the port whose key is removed. scripts:
        see `Scripts`. objection: checks the ports' values. asks: ports whose script is a condition.
        concurrent: the children run at the same time. in_turn: each child runs once, in order.
        condition: a leaf that tests something and ends at once. retries: it runs the first child
        again after a failure. flow: which keys surely have a value after the node; the default
        relies on nothing that the children write. codes: the failure codes of the node.

    For displays:
        title: the node's name in words; by default its name in YAML. port_words: its ports in
        words. around: a decorator's text in the line of its child. roles: each child's role in
        words.
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
    choices: Mapping[str, str] = field(default_factory=dict)
    removes: str | None = None
    scripts: Scripts = Scripts.ASKED
    asks: tuple[str, ...] = ()
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
    choices: Mapping[str, str]
    removes: str | None
    scripts: Scripts
    asks: tuple[str, ...]
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
    """A node that decides which of its children run; by default it has one child or more."""
    further.setdefault("children", (1, None))
    return NodeSpec(type_, (yaml,), Kind.CONTROL, doc, by_name(*ports), **further)


def decorator(
    type_: str, yaml: str, doc: str, *ports: Port, **further: Unpack[Further]
) -> NodeSpec:
    """A node around one child. In YAML it may stand beside it; a bare value sets its first port."""
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
    """A node without children; in YAML a bare value sets its first port."""
    spellings = (yaml,) if isinstance(yaml, str) else yaml
    further.setdefault("first", ports[0].name if ports else None)
    further.setdefault("flow", as_written)
    return NodeSpec(type_, spellings, Kind.LEAF, doc, by_name(*ports), **further)


def by_name(*ports: Port) -> dict[str, Port]:
    """The ports by name, for `NodeSpec.ports`."""
    return {port.name: port for port in ports}


def output_port(name: str, type_: Any, doc: str, default: Any = MISSING) -> Port:
    """An output of a node; with the default None a tree may leave it out."""
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


def time_ports(doc: str, least: float = 0) -> tuple[Port, Port]:
    """The ports `duration` and `msec` (BehaviorTree.CPP's); a tree gives exactly one of them.

    least: of `duration`, s.
    """
    return (
        input_port("duration", float, doc, None, unit="s", least=least),
        input_port("msec", int, f"{doc}, in milliseconds", None, least=0),
    )


TIME = (("duration", "msec"),)
"""`NodeSpec.one_of` of a node with `time_ports`."""
