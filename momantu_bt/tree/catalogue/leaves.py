"""Leaves: nodes without children."""

from __future__ import annotations

from momantu_bt.skill import Port
from momantu_bt.tree.catalogue.spec import TIME, CodeText, ScriptText, input_port, leaf, time_ports

LEAVES = (
    leaf("AlwaysSuccess", ("succeed", "always_success"), "Succeeds at once."),
    leaf("AlwaysFailure", ("always_failure",), "Fails at once, with FAILED."),
    leaf(
        "Fail",
        ("fail",),
        "Fails at once with a code.",
        input_port("code", CodeText, "upper-case words joined by underscores"),
        input_port("message", str, "one sentence for a person", ""),
    ),
    leaf("Script", ("script",), "Runs a script.", input_port("code", ScriptText, "the script")),
    leaf(
        "ScriptCondition",
        ("condition",),
        "Succeeds when a condition holds, fails when it does not.",
        input_port("code", ScriptText, "the condition"),
    ),
    leaf(
        "SetBlackboard",
        ("set",),
        "Writes a value to a key.",
        Port("key", "out", object, "the key"),
        input_port("value", object, "what it becomes"),
        xml={"key": "output_key"},
    ),
    leaf(
        "UnsetBlackboard",
        ("unset",),
        "Removes a key.",
        Port("key", "out", object, "the key"),
    ),
    leaf(
        "Sleep",
        ("wait",),
        "Waits.",
        *time_ports("how long"),
        xml={"duration": ""},
        one_of=TIME,
    ),
)
"""All of them."""
