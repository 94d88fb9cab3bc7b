"""Conditions that assign, cases that no value equals, and handlers that swallow a person's no."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.geometry import Pose2D
from momantu_bt.service import Service
from momantu_bt.tree.check.checker import check as check_document
from momantu_bt.tree.files.xml.format import read as read_xml
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.files.yaml.writer import write
from momantu_bt.tree.registry import Registry

Check = Callable[[str], list[Problem]]
Expect = Callable[..., None]
Fine = Callable[[str], None]
ASK = "- ask: {question: Which?, choices: [left, right], answer: $way}"


def main(*lines: str, values: str = "") -> str:
    head = f"values: {values}\n" if values else ""
    return head + "trees:\n  Main:\n" + "".join(f"    {line}\n" for line in lines)


@pytest.mark.parametrize(
    "node",
    [
        "{succeed: , skip_if: $n «=» 3}",
        "{succeed: , while: '$n «:=» 3'}",
        "{condition: '$n «=» 3'}",
        "{precondition: {if: $n «=» 3, child: succeed}}",
        "{if: $n «=» 3, then: succeed}",
        "{succeed: , fail_if: $n > 1; $n «=» $n == 2}",
    ],
)
def test_a_condition_that_assigns(expect: Expect, node: str) -> None:
    expect("assigns", main(f"- {node}", values="{n: 1}"), hint="did you mean `==`?")


@pytest.mark.parametrize(
    "node",
    [
        "{succeed: , skip_if: '$n := $n + 1; $n > 3'}",
        "{succeed: , while: $n -= 1}",
        "{succeed: , on_success: $n = 3}",
        "{script: $n = 3}",
    ],
)
def test_a_condition_that_assigns_and_then_compares(fine: Fine, node: str) -> None:
    fine(main(f"- {node}", "- {succeed: , skip_if: $n == 3}", values="{n: 1}"))


XML = (
    '<root BTCPP_format="4"><BehaviorTree ID="Main"><Sequence><Script code="n := 1"/>\n'
    '<AlwaysSuccess _skipIf="n = 3"/>\n<ScriptCondition code="n = 3"/>\n'
    "</Sequence></BehaviorTree></root>"
)


def test_in_a_file_of_behaviortree_cpp_it_is_a_warning(check: Check) -> None:
    found = check(XML)
    assert [(p.code, p.severity, p.place.line, p.place.column) for p in found] == [
        ("assigns", Severity.WARNING, 2, 27),
        ("assigns", Severity.WARNING, 3, 26),
    ]


def test_the_converted_file_keeps_it_as_a_warning(check: Check) -> None:
    document, _ = read_xml(XML, "t.xml", Registry())
    text = write(document)
    assert text.count("{btcpp: n = 3}") == 2
    assert {p.severity for p in check(text)} == {Severity.WARNING}
    assert read(text, "t.yaml")[0].trees == document.trees


@pytest.mark.parametrize(
    ("lines", "hint"),
    [
        ((ASK, "- {switch: $way, cases: {left: succeed, «rigth»: succeed}}"), "right"),
        ((ASK, "- {switch: $way, cases: {«up»: succeed, left: succeed}}"), "left, right"),
    ],
)
def test_a_case_that_no_value_equals(expect: Expect, lines: tuple[str, ...], hint: str) -> None:
    lines = (lines[0], lines[1][:-1] + ", default: succeed}")
    expect("dead-case", main(*lines), hint=hint)


@pytest.mark.parametrize(
    "lines",
    [
        (ASK, "- {switch: $way, cases: {left: succeed, right: succeed}, default: succeed}"),
        (
            ASK.replace("left, right", '"1", "2"'),
            "- {switch: $way, cases: {1: succeed, 2: succeed}, default: succeed}",
        ),
        (
            "- ask: {question: Which?, answer: $way}",
            "- {switch: $way, cases: {up: succeed, down: succeed}, default: succeed}",
        ),
        (
            ASK,
            "- repeat:",
            "    cycles: 2",
            "    child:",
            "      - {switch: $way, cases: {left: succeed, up: succeed}, default: succeed}",
            "      - set: {key: $way, value: up}",
        ),
        (
            ASK,
            "- repeat:",
            "    cycles: 2",
            "    child:",
            "      - {switch: $way, cases: {left: succeed, up: succeed}, default: succeed}",
            "      - script: $way = 'up'",
        ),
        (
            ASK,
            "- script: $way = 'up'",
            "- {switch: $way, cases: {left: succeed, up: succeed}, default: succeed}",
        ),
    ],
)
def test_a_case_that_some_value_may_equal(fine: Fine, lines: tuple[str, ...]) -> None:
    fine(main(*lines))


def catching(handler: str, tried: str = "[navigate: {in_front_of: table_a}]") -> str:
    return main("recover:", "  attempts: 2", f"  try: {tried}", f"  catch: {handler}")


SWITCH = "{switch: $failure.code, cases: {NO_PATH: succeed, «%s»: succeed}, default: succeed}"


def test_a_case_for_a_code_that_cannot_arrive(expect: Expect) -> None:
    handler = "{NO_PATH | PATH_BLOCKED: " + SWITCH % "PATH_BLOKED" + "}"
    expect("dead-case", catching(handler), hint="did you mean PATH_BLOCKED?")
    handler = "{any: " + SWITCH % "SLIPPED" + "}"
    expect("dead-case", catching(handler), hint="NOT_LOCALIZED")


def test_a_case_for_a_code_that_can_arrive(fine: Fine) -> None:
    for code, named in (("PATH_BLOCKED", "NO_PATH | PATH_BLOCKED"), ("HUNG", "any")):
        case = (SWITCH % code).replace("«", "").replace("»", "")
        fine(catching(f"{{{named}: {case}}}"))


CONFIRM = "[confirm: Go?, navigate: {in_front_of: table_a}]"


def test_any_that_handles_a_no(expect: Expect) -> None:
    expect("swallowed-no", catching("{«any»: relocalize}", CONFIRM), hint="DECLINED | any")
    inside = catching("{NO_ANSWER: again, «any»: relocalize}", "Sub") + "  Sub: [confirm: Go?]\n"
    expect("swallowed-no", inside)


@pytest.mark.parametrize(
    ("handler", "tried"),
    [
        ("{DECLINED | any: relocalize}", CONFIRM),
        ("{DECLINED: relocalize, any: relocalize}", CONFIRM),
        ("{any: relocalize}", "{fallback: [confirm: Go?, relocalize]}"),
        ("{any: relocalize}", "{confirm: Go?, else_fail: NO_WAY}"),
        ("{any: relocalize}", "{ask: {question: What?, answer: $said}}"),
    ],
)
def test_any_that_handles_no_refusal(check: Check, handler: str, tried: str) -> None:
    text = "momantu_bt: 1\nworld: rooms\n" + catching(handler, tried)
    assert [p.code for p in check(text) if p.code != "unread-output"] == []


class Where(Service):
    """A service."""

    publishes = {"quality": float, "pose": Pose2D}


def _with_service(registry: Registry, node: str) -> list[Problem]:
    text = f"momantu_bt: 1\ntrees: {{Main: {{{node}}}}}\n"
    document, _ = read(text.replace("«", "").replace("»", ""), "t.yaml")
    return check_document(document, replace(registry, services={"where": Where})).problems


@pytest.mark.parametrize(
    ("node", "code", "hint"),
    [
        ("condition: «$@where».qualty > 1", "unknown-part", "did you mean quality?"),
        ("condition: «$@where».quality == 'good'", "wrong-type", ""),
        ("wait: «$@where.pose»", "wrong-type", ""),
        ("wait: «$@where.pose.z»", "unknown-part", "x, y, yaw"),
    ],
)
def test_what_a_service_publishes(registry: Registry, node: str, code: str, hint: str) -> None:
    found = _with_service(registry, node)
    text = f"momantu_bt: 1\ntrees: {{Main: {{{node}}}}}\n"
    assert [(p.code, p.place.line, p.place.column) for p in found] == [
        (code, 2, text.splitlines()[1].index("«") + 1)
    ]
    assert hint in found[0].hint


def test_what_a_service_publishes_fits(registry: Registry) -> None:
    for node in ("condition: $@where.quality > 0.5", "wait: $@where.pose.x"):
        assert _with_service(registry, node) == []
