"""Control nodes: sequences, fallbacks, parallels, branches and recovery."""

from __future__ import annotations

from momantu_bt.tree.catalogue.spec import Kind, NodeSpec, by_name, control, input_port

_SEQUENCES = (
    control(
        "Sequence",
        "sequence",
        "Children in turn until one fails; goes on where it was.",
    ),
    control(
        "AsyncSequence",
        "async_sequence",
        "A sequence that can be interrupted in between.",
    ),
    control(
        "SequenceWithMemory",
        "sequence_with_memory",
        "A sequence that starts again at the child that failed.",
    ),
    control(
        "ReactiveSequence",
        "reactive_sequence",
        "Earlier children are asked again on each tick.",
    ),
    control("Fallback", "fallback", "Children in turn until one succeeds."),
    control(
        "AsyncFallback",
        "async_fallback",
        "A fallback that can be interrupted in between.",
    ),
    control(
        "ReactiveFallback",
        "reactive_fallback",
        "Earlier children are asked again on each tick.",
    ),
    control(
        "RoundRobin",
        "round_robin",
        "Starts with the next child each time; a child that fails hands on to the one after it.",
    ),
)

_PARALLEL = (
    control(
        "Parallel",
        "parallel",
        "Children together; ends when enough of them have succeeded or failed.",
        input_port("success_count", int, "how many successes end it well; -1 is all", -1),
        input_port("failure_count", int, "how many failures end it badly; -1 is all", 1),
        concurrent=True,
    ),
    control(
        "ParallelAll",
        "parallel_all",
        "Children together until all have ended.",
        input_port("max_failures", int, "how many failures make it fail; -1 is all", 1),
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
        by_name(input_port("attempts", int, "how often `try` runs at most")),
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

CONTROLS = (*_SEQUENCES, *_PARALLEL, *_BRANCHES, *_RECOVERY)
"""All of them."""
