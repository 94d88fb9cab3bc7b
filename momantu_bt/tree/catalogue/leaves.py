"""Leaves: nodes without children."""

from __future__ import annotations

from typing import Literal

from momantu_bt.failure import FAILED
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue.spec import TIME, input_port, leaf, time_ports
from momantu_bt.values.kinds import CodeText, ScriptText

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
    leaf(
        "Ask",
        ("ask",),
        "Asks the person at the terminal.",
        input_port("question", str, "what to ask"),
        Port("answer", "out", str, "the key of the answer"),
        input_port("choices", tuple[str, ...], "the answers it takes; none: any text", ()),
        input_port("default", str | None, "the answer when nobody gives one", None),
    ),
    leaf(
        "Confirm",
        ("confirm",),
        "Asks the person at the terminal; yes is success, no is failure.",
        input_port("question", str, "what to ask, for yes or no"),
        input_port("default", bool | None, "the answer when nobody gives one", None),
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
        keys=("key",),
    ),
    leaf(
        "UnsetBlackboard",
        ("unset",),
        "Removes a key.",
        Port("key", "out", object, "the key"),
        keys=("key",),
    ),
    leaf(
        "Sleep",
        ("wait",),
        "Waits.",
        *time_ports("how long"),
        xml={"duration": ""},
        one_of=TIME,
    ),
    leaf(
        "WasEntryUpdated",
        ("was_entry_updated",),
        "Succeeds when a key was written since the last time, fails when it was not.",
        input_port("entry", object, "the key that is watched"),
        keys=("entry",),
        may_be_empty=("entry",),
    ),
    leaf(
        "TestNode",
        ("test_node",),
        "Does what a test prescribes, in place of a skill.",
        input_port(
            "return_status",
            Literal["SUCCESS", "FAILURE", "RUNNING", "SKIPPED"],
            "how it ends; RUNNING is never",
            "SUCCESS",
        ),
        input_port("return_status_script", ScriptText, "gives the status instead", ""),
        input_port("async_delay", float, "how long it runs before its end", 0.0, "s", least=0),
        input_port("code", CodeText, "what it fails with", FAILED),
        input_port("message", str, "the failure's sentence", "the test prescribes a failure"),
        input_port("success_script", ScriptText, "runs at its end with SUCCESS", ""),
        input_port("failure_script", ScriptText, "runs at its end with FAILURE", ""),
        input_port("post_script", ScriptText, "runs at its end, after those two", ""),
    ),
)
"""All of them."""
