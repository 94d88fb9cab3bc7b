"""Every built-in node: its canonical type, its spelling in YAML, its ports and its children.

Canonical types and their meaning are BehaviorTree.CPP 4's where it has the node; the rest is
ours. The engine's classes are keyed by the canonical type, the readers by the spelling.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Literal

from momantu_bt.skill import MISSING, Port


class Kind(StrEnum):
    """What a built-in node is to its parent and to its children."""

    CONTROL = "control"
    DECORATOR = "decorator"
    LEAF = "leaf"


class ScriptText(str):
    """The type of a port that holds a script in canonical form (`&& || !`, bare names)."""


class CodeText(str):
    """The type of a port that holds a failure code."""


@dataclass(frozen=True, slots=True)
class NodeSpec:
    """One built-in node.

    yaml: the spellings, preferred first. first: the port that a scalar in YAML means.
    modifier: the YAML spelling may stand beside a node key. children: least and most (None: any).
    positions: what each child is, where they have names of their own in YAML (if, then, else).
    handlers: takes `catch:`. xml: attribute names of BehaviorTree.CPP for ports named otherwise.
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


def _ports(*ports: Port) -> dict[str, Port]:
    return {port.name: port for port in ports}


def _in(name: str, type_: Any, doc: str, default: Any = MISSING, unit: str | None = None) -> Port:
    return Port(name, "in", type_, doc, default, unit)


def _control(
    type_: str,
    yaml: str,
    doc: str,
    *ports: Port,
    least: int = 1,
    most: int | None = None,
    concurrent: bool = False,
) -> NodeSpec:
    return NodeSpec(
        type_,
        (yaml,),
        Kind.CONTROL,
        doc,
        _ports(*ports),
        children=(least, most),
        concurrent=concurrent,
    )


_SEQUENCES = (
    _control(
        "Sequence",
        "sequence",
        "Children in turn until one fails; goes on where it was.",
    ),
    _control(
        "AsyncSequence",
        "async_sequence",
        "A sequence that can be interrupted in between.",
    ),
    _control(
        "SequenceWithMemory",
        "sequence_with_memory",
        "A sequence that starts again at the child that failed.",
    ),
    _control(
        "ReactiveSequence",
        "reactive_sequence",
        "Earlier children are asked again on each tick.",
    ),
    _control("Fallback", "fallback", "Children in turn until one succeeds."),
    _control(
        "AsyncFallback",
        "async_fallback",
        "A fallback that can be interrupted in between.",
    ),
    _control(
        "ReactiveFallback",
        "reactive_fallback",
        "Earlier children are asked again on each tick.",
    ),
    _control(
        "RoundRobin",
        "round_robin",
        "Starts with the next child each time; a child that fails hands on to the one after it.",
    ),
)

_PARALLEL = (
    _control(
        "Parallel",
        "parallel",
        "Children together; ends when enough of them have succeeded or failed.",
        _in("success_count", int, "how many successes end it well; -1 is all", -1),
        _in("failure_count", int, "how many failures end it badly; -1 is all", 1),
        concurrent=True,
    ),
    _control(
        "ParallelAll",
        "parallel_all",
        "Children together until all have ended.",
        _in("max_failures", int, "how many failures make it fail; -1 is all", 1),
        concurrent=True,
    ),
)

_BRANCHES = (
    NodeSpec(
        "IfThenElse",
        ("if",),
        Kind.CONTROL,
        "Asks the first child once, then runs the second or the third.",
        children=(2, 3),
        positions=("if", "then", "else"),
    ),
    NodeSpec(
        "WhileDoElse",
        ("while_do",),
        Kind.CONTROL,
        "Asks the first child on each tick and runs the second or the third.",
        children=(2, 3),
        positions=("while_do", "do", "else"),
    ),
)

_RECOVERY = (
    NodeSpec(
        "Recover",
        ("recover",),
        Kind.CONTROL,
        "Runs `try`; when it fails runs the handler of its code, then `try` again.",
        _ports(_in("attempts", int, "how often `try` runs at most")),
        children=(1, 1),
        positions=("try",),
        handlers=True,
    ),
    NodeSpec(
        "Handle",
        ("handle",),
        Kind.CONTROL,
        "Runs `try`; when it fails the result of its code's handler is the result.",
        children=(1, 1),
        positions=("try",),
        handlers=True,
    ),
)


def _decorator(
    type_: str,
    yaml: str,
    doc: str,
    *ports: Port,
    modifier: bool = True,
    xml: Mapping[str, str] | None = None,
) -> NodeSpec:
    return NodeSpec(
        type_,
        (yaml,),
        Kind.DECORATOR,
        doc,
        _ports(*ports),
        first=ports[0].name if ports else None,
        children=(1, 1),
        positions=("child",),
        modifier=modifier,
        xml=xml or {},
    )


_DECORATORS = (
    _decorator(
        "RetryUntilSuccessful",
        "retry",
        "Runs the child again when it fails.",
        _in("attempts", int, "tries in all; -1 is without end"),
        xml={"attempts": "num_attempts"},
    ),
    _decorator(
        "Repeat",
        "repeat",
        "Runs the child again when it succeeds.",
        _in("cycles", int, "runs in all; -1 is without end"),
        xml={"cycles": "num_cycles"},
    ),
    _decorator(
        "Timeout",
        "timeout",
        "Halts the child and fails with TIMEOUT when it takes longer.",
        _in("duration", float, "the limit", unit="s"),
        xml={"duration": "msec"},
    ),
    _decorator(
        "Delay",
        "delay",
        "Waits before the child.",
        _in("duration", float, "how long", unit="s"),
        xml={"duration": "delay_msec"},
    ),
    _decorator("Inverter", "invert", "Success becomes failure and failure success."),
    _decorator("ForceSuccess", "force_success", "Whatever the child's end: success."),
    _decorator("ForceFailure", "force_failure", "Whatever the child's end: failure."),
    _decorator(
        "KeepRunningUntilFailure",
        "keep_running_until_failure",
        "Runs the child again and again until it fails.",
    ),
    _decorator(
        "RunOnce",
        "run_once",
        "Runs the child once in the life of the tree.",
        _in(
            "then_skip",
            bool,
            "skipped afterwards, instead of repeating the result",
            True,
        ),
    ),
    _decorator(
        "Precondition",
        "precondition",
        "Asks a condition before the child starts.",
        _in("if", ScriptText, "the condition"),
        _in(
            "else",
            Literal["FAILURE", "SUCCESS", "RUNNING", "SKIPPED"],
            "the result when it does not hold",
            "FAILURE",
        ),
        modifier=False,
    ),
    NodeSpec(
        "ForEach",
        ("for_each",),
        Kind.DECORATOR,
        "Runs the child for each item of a list, until it fails.",
        _ports(
            _in("in", tuple, "the items"),
            Port("as", "out", object, "the key that holds the item of the round"),
        ),
        children=(1, 1),
        positions=("child",),
    ),
)


def _leaf(
    type_: str,
    yaml: tuple[str, ...],
    doc: str,
    *ports: Port,
    xml: Mapping[str, str] | None = None,
) -> NodeSpec:
    first = ports[0].name if ports else None
    return NodeSpec(type_, yaml, Kind.LEAF, doc, _ports(*ports), first=first, xml=xml or {})


_LEAVES = (
    _leaf("AlwaysSuccess", ("succeed", "always_success"), "Succeeds at once."),
    _leaf("AlwaysFailure", ("always_failure",), "Fails at once, with FAILED."),
    _leaf(
        "Fail",
        ("fail",),
        "Fails at once with a code.",
        _in("code", CodeText, "upper-case words joined by underscores"),
        _in("message", str, "one sentence for a person", ""),
    ),
    _leaf("Script", ("script",), "Runs a script.", _in("code", ScriptText, "the script")),
    _leaf(
        "ScriptCondition",
        ("condition",),
        "Succeeds when a condition holds, fails when it does not.",
        _in("code", ScriptText, "the condition"),
    ),
    _leaf(
        "SetBlackboard",
        ("set",),
        "Writes a value to a key.",
        Port("key", "out", object, "the key"),
        _in("value", object, "what it becomes"),
        xml={"key": "output_key"},
    ),
    _leaf(
        "UnsetBlackboard",
        ("unset",),
        "Removes a key.",
        Port("key", "out", object, "the key"),
    ),
    _leaf(
        "Sleep",
        ("wait",),
        "Waits.",
        _in("duration", float, "how long", unit="s"),
        xml={"duration": "msec"},
    ),
)

SUBTREE = "SubTree"
"""Canonical type of a node that runs another tree of the document; `Node.target` names it."""

BUILT_IN: Mapping[str, NodeSpec] = {
    spec.type: spec
    for spec in (
        *_SEQUENCES,
        *_PARALLEL,
        *_BRANCHES,
        *_RECOVERY,
        *_DECORATORS,
        *_LEAVES,
    )
}
"""Built-in nodes by canonical type."""

SPELLED: Mapping[str, NodeSpec] = {name: spec for spec in BUILT_IN.values() for name in spec.yaml}
"""Built-in nodes by YAML spelling."""

FORCED: Mapping[str, str] = {"success": "ForceSuccess", "failure": "ForceFailure"}
"""What the modifier `force:` makes of its value."""

PRE_CONDITIONS = ("fail_if", "succeed_if", "skip_if", "while")
"""Conditions asked before a node's tick, in this order (BehaviorTree.CPP's)."""

POST_SCRIPTS = ("on_success", "on_failure", "on_halt", "after")
"""Scripts run when a node ends: so, or (`after`) with success or failure."""

CONDITIONS = (*PRE_CONDITIONS, *POST_SCRIPTS)
"""Keys of `Node.conditions`."""

NODE_KEYS = ("name", "note", "disabled")
"""Modifiers that are neither decorators nor conditions."""

MODIFIERS: Mapping[str, str] = {
    **dict.fromkeys(NODE_KEYS, "key"),
    **dict.fromkeys(CONDITIONS, "condition"),
    **{spec.yaml[0]: "decorator" for spec in BUILT_IN.values() if spec.modifier},
    "force": "decorator",
}
"""Reserved modifier names of YAML, and what each one is."""
