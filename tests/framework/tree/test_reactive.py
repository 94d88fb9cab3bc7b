"""Children of reactive nodes that halt each other."""

from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.formats.problems import Problem
from momantu_bt.running.api import run

Check = Callable[[str], list[Problem]]
GO = "{navigate: {in_front_of: table_a}}"
ASK = "{condition: $@robot.stamp < 90}"


def found(check: Check, nodes: str, more: str = "") -> list[tuple[str, int]]:
    text = f"momantu_bt: 1\nworld: rooms\nmain: Main\ntrees:\n  Main:\n    {nodes}\n{more}"
    problems = [problem for problem in check(text) if problem.code != "unwatched-guard"]
    return [(problem.code, problem.place.line) for problem in problems]


@pytest.mark.parametrize(
    "children",
    [
        f"[{GO}, relocalize]",
        f"[{ASK}, {GO}, relocalize]",
        f"[{{sequence: [{ASK}, {GO}]}}, {{sequence: [{ASK}, relocalize]}}]",
        "[{navigate: {in_front_of: table_a}, retry: 3, timeout: 9 s}, {wait: 2 s}]",
        "[{wait: 1 s}, relocalize]",
        "[Sub, relocalize]",
        f"[{{recover: {{attempts: 2, try: {GO}, catch: {{any: relocalize}}}}}}, relocalize]",
    ],
)
def test_two_nodes_that_take_long(check: Check, children: str) -> None:
    sub = f"  Sub: [{GO}]\n" if "Sub" in children else ""
    assert found(check, f"reactive_sequence: {children}", sub) == [("restarts", 6)]


def test_two_nodes_of_a_fallback(check: Check) -> None:
    assert found(check, f"reactive_fallback: [{GO}, relocalize]") == [("restarts", 6)]
    children = f"[{{fallback: [{ASK}, {GO}]}}, relocalize]"
    assert found(check, f"reactive_fallback: {children}") == [("restarts", 6)]


@pytest.mark.parametrize(
    "tree",
    [
        f"reactive_sequence: [{ASK}, {GO}]",
        f"reactive_sequence: [{{fallback: [{ASK}, relocalize]}}, {GO}]",
        f"reactive_sequence: [{{relocalize: , run_once: }}, {GO}]",
        f"reactive_sequence: [{{relocalize: , skip_if: $@robot.stamp < 9}}, {GO}]",
        f"reactive_sequence: [{{relocalize: , disabled: true}}, {GO}]",
        f"reactive_sequence: [{GO}, {{say: hi}}]",
        f"reactive_fallback: [{ASK}, {GO}]",
        f"reactive_fallback: [{{sequence: [{ASK}, relocalize]}}, {GO}]",
        f"sequence: [{GO}, relocalize]",
    ],
)
def test_nodes_that_do_not_halt_each_other(check: Check, tree: str) -> None:
    assert "restarts" not in [code for code, _ in found(check, tree)]


@pytest.mark.parametrize(
    ("tree", "succeeded"),
    [
        ("reactive_sequence: [{wait: 1 s}, {wait: 1 s}]", False),
        ("sequence: [{wait: 1 s}, {wait: 1 s}]", True),
    ],
)
def test_the_warning_is_true(tmp_path: Path, tree: str, succeeded: bool) -> None:
    """Two waits in a reactive sequence never end."""
    file = tmp_path / "t.yaml"
    file.write_text(f"momantu_bt: 1\ntrees:\n  Main:\n    {tree}\n    timeout: 20 s\n")
    report = run(file, world="none")
    assert (report.status == "SUCCESS") is succeeded
    assert succeeded or report.failure.code == "TIMEOUT"
