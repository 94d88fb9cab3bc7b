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


def _switch(cases: int) -> NodeSpec:
    ports = [input_port(f"case_{i}", object, "a value of `variable`") for i in range(1, cases + 1)]
    return NodeSpec(
        f"Switch{cases}",
        ("switch",),
        Kind.CONTROL,
        "Runs the child of the case that equals the variable, else the last child.",
        by_name(input_port("variable", object, "what is compared, on each tick"), *ports),
        children=(cases + 1, cases + 1),
        switch=cases,
    )


_SWITCHES = tuple(_switch(cases) for cases in range(2, 7))

_RECOVERY = (
    NodeSpec(
        "Recover",
        ("recover",),
        Kind.CONTROL,
        "Runs `try`; when it fails runs the handler of its code, then `try` again.",
        by_name(input_port("attempts", int, "how often `try` runs at most", least=1)),
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
    control(
        "TryCatch",
        "try_catch",
        "All children but the last in turn; when one fails the last one cleans up, and it fails.",
        input_port("catch_on_halt", bool, "the last child also cleans up after a halt", False),
        least=2,
    ),
)

CONTROLS = (*_SEQUENCES, *_PARALLEL, *_BRANCHES, *_SWITCHES, *_RECOVERY)
"""All of them."""
