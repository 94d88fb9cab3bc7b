"""Decorators: nodes around one child."""

from __future__ import annotations

from typing import Literal

from momantu_bt.tree.catalogue.spec import (
    TIME,
    Kind,
    NodeSpec,
    by_name,
    decorator,
    input_port,
    output_port,
    time_ports,
)
from momantu_bt.values.kinds import CodeText, Queue, ScriptText

_PLAIN = (
    decorator(
        "RetryUntilSuccessful",
        "retry",
        "Runs the child again when it fails.",
        input_port("attempts", int, "tries in all; -1 is without end", least=1, endless=True),
        xml={"attempts": "num_attempts"},
    ),
    decorator(
        "Repeat",
        "repeat",
        "Runs the child again when it succeeds.",
        input_port("cycles", int, "runs in all; -1 is without end", least=1, endless=True),
        xml={"cycles": "num_cycles"},
    ),
    decorator(
        "Timeout",
        "timeout",
        "Halts the child and fails with TIMEOUT when it takes longer.",
        *time_ports("the limit"),
        xml={"duration": ""},
        one_of=TIME,
    ),
    decorator(
        "Delay",
        "delay",
        "Waits before the child.",
        *time_ports("how long"),
        xml={"duration": "", "msec": "delay_msec"},
        one_of=TIME,
    ),
    decorator("Inverter", "invert", "Success becomes failure and failure success."),
    decorator("ForceSuccess", "force_success", "Whatever the child's end: success."),
    decorator("ForceFailure", "force_failure", "Whatever the child's end: failure."),
    decorator(
        "ElseFail",
        "else_fail",
        "When the child fails, fails with a code of one's own; the child's failure is its cause.",
        input_port("code", CodeText, "upper-case words joined by underscores"),
        input_port("message", str, "one sentence for a person", ""),
    ),
    decorator(
        "KeepRunningUntilFailure",
        "keep_running_until_failure",
        "Runs the child again and again until it fails.",
    ),
    decorator(
        "RunOnce",
        "run_once",
        "Runs the child once in the life of the tree.",
        input_port(
            "then_skip",
            bool,
            "skipped afterwards, instead of repeating the result",
            True,
        ),
    ),
    decorator(
        "Precondition",
        "precondition",
        "Asks a condition before the child starts.",
        input_port("if", ScriptText, "the condition"),
        input_port(
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
        by_name(
            input_port("in", tuple, "the items"),
            output_port("as", object, "the key that holds the item of the round"),
        ),
        children=(1, 1),
        positions=("child",),
        item=("as", "in"),
    ),
)


def _loop(type_: str, yaml: str, item: type) -> NodeSpec:
    return decorator(
        type_,
        yaml,
        "Takes item after item from a queue and runs the child for each, until it fails.",
        input_port("queue", Queue[item], "a list, or a text such as `1;2;3`"),  # type: ignore[valid-type]
        input_port(
            "if_empty",
            Literal["SUCCESS", "FAILURE", "SKIPPED"],
            "the result when the queue is empty, at last or from the start",
            "SUCCESS",
        ),
        output_port("value", item, "the key that holds the item", None),
        modifier=False,
        item=("value", "queue"),
    )


_LOOPS = (
    _loop("LoopInt", "loop_int", int),
    _loop("LoopDouble", "loop_number", float),
    _loop("LoopString", "loop_text", str),
    _loop("LoopBool", "loop_bool", bool),
)

_ENTRY = input_port("entry", object, "the key that is watched")

_UPDATES = (
    decorator(
        "SkipUnlessUpdated",
        "skip_unless_updated",
        "Runs the child when a key was written since the last time; is skipped otherwise.",
        _ENTRY,
        keys=("entry",),
        may_be_empty=("entry",),
    ),
    decorator(
        "WaitValueUpdate",
        "wait_value_update",
        "Waits until a key is written, then runs the child.",
        _ENTRY,
        keys=("entry",),
        may_be_empty=("entry",),
    ),
)

DECORATORS = (*_PLAIN, *_LOOPS, *_UPDATES)
"""All of them."""
