"""Numbers within the bounds of their ports, and inputs of which exactly one is given."""

from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

import momantu_bt
from momantu_bt.formats.problems import Problem
from momantu_bt.skill import In, Port, Skill
from momantu_bt.tree.catalogue import NODES
from momantu_bt.tree.check.checker import check as check_document
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.registry import Registry
from momantu_bt.values.convert import convert
from momantu_bt.values.words import ConversionError

Check = Callable[[str], list[Problem]]

Expect = Callable[..., None]
NUMBERS = st.integers(-50, 50)


@given(NUMBERS, NUMBERS, NUMBERS, st.booleans())
def test_a_number_is_taken_exactly_when_it_is_within_the_bounds(
    value: int, least: int, most: int, endless: bool
) -> None:
    port = Port("n", "in", int, "", least=least, most=most, endless=endless)
    inside = least <= value <= most or (endless and value == -1)
    assert _fits(value, port) == inside
    assert _fits(str(value), port) == inside
    assert _fits([value], replace(port, type=tuple[int, ...])) == inside
    assert _fits(value, replace(port, type=int | None)) == inside


def _fits(value: object, port: Port) -> bool:
    try:
        convert(value, port)
    except ConversionError:
        return False
    return True


def test_no_bounds_are_asked_of_what_is_no_number() -> None:
    assert convert(None, Port("n", "in", int | None, "", least=1)) is None
    assert convert("a", Port("n", "in", str | int, "", least=1)) == "a"


def test_not_a_number_is_out_of_every_range() -> None:
    assert not _fits(float("nan"), Port("n", "in", float, "", least=0))


def test_defaults_of_built_in_nodes_are_within_their_bounds() -> None:
    bounded = [p for spec in NODES.values() for p in spec.ports.values() if p.bounds]
    assert len(bounded) > 10
    for port in bounded:
        if isinstance(port.default, int | float):
            assert port.allows(port.default), port


@pytest.mark.parametrize(
    ("node", "hint"),
    [
        ("{succeed: , retry: «0»}", "at least 1, or -1 for no end"),
        ("{succeed: , retry: «-2»}", "at least 1, or -1 for no end"),
        ("{succeed: , repeat: «0»}", "at least 1, or -1 for no end"),
        ("{recover: {attempts: «0», try: relocalize, catch: {any: again}}}", "at least 1"),
        ("{wait: «-1»}", "at least 0 s"),
        ("{wait: «-5 ms»}", "-5 ms is out of range; expected at least 0 s"),
        ("{wait: {msec: «-1»}}", "at least 0"),
        ("{succeed: , timeout: «-1 min»}", "at least 0.001 s"),
        ("{succeed: , delay: «-0.1»}", "at least 0 s"),
        ("{succeed: , rate_controller: «0»}", "at least 1e-09 Hz"),
        ("{succeed: , distance_controller: «-1 m»}", "at least 0 m"),
        ("{recovery_node: {number_of_retries: «-1», children: [succeed, succeed]}}", "at least 0"),
    ],
)
def test_a_number_out_of_range(expect: Expect, node: str, hint: str) -> None:
    expect("wrong-value", f"trees:\n  Main: [{node}]\n", hint)


@pytest.mark.parametrize(
    "node",
    [
        "{succeed: , retry: 1}",
        "{succeed: , retry: -1}",
        "{succeed: , repeat: -1}",
        "{wait: 0}",
        "{succeed: , rate_controller: 0.1 Hz}",
    ],
)
def test_the_ends_of_the_ranges(fine: Callable[[str], None], node: str) -> None:
    fine(f"trees:\n  Main: [{node}]\n")


def test_a_value_that_comes_by_wire(expect: Expect) -> None:
    expect(
        "wrong-value", "values: {n: «0»}\ntrees:\n  Main: [{succeed: , retry: $n}]\n", "at least"
    )


def test_a_value_that_only_the_run_knows_fails_there(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    path = tmp_path_factory.mktemp("ranges") / "late.yaml"
    steps = "[{script: '$n := 1 - 1'}, {succeed: , retry: $n}]"
    path.write_text(f"momantu_bt: 1\ntrees:\n  Main: {steps}\n", encoding="utf-8")
    report = momantu_bt.run(path, world="none", max_time=1.0, registry=Registry())
    assert report.failure is not None
    assert report.failure.code == "WRONG_TYPE"
    assert "at least 1" in report.failure.message


class Turn(Skill):
    """Turn."""

    angle: float | None = In(None, unit="rad", least=-4, most=4, doc="by so much")
    to: str | None = In(None, doc="towards this")
    one_of = (("angle", "to"),)


def problems(node: str) -> list[Problem]:
    document, found = read(f"momantu_bt: 1\nvalues: {{a: 1}}\ntrees:\n  Main: [{node}]\n", "t.yaml")
    checked = check_document(document, Registry({"turn": Turn}), reading=found)
    return [problem for problem in checked.problems if problem.code != "unused-value"]


@pytest.mark.parametrize("node", ["{turn: 1}", "{turn: $a}", "{turn: {angle: null, to: door}}"])
def test_one_of_the_inputs_is_given(node: str) -> None:
    assert problems(node) == []


@pytest.mark.parametrize(
    ("node", "code", "words"),
    [
        ("turn", "missing-input", "exactly one of the inputs angle, to"),
        ("{turn: {angle: null}}", "missing-input", "exactly one"),
        ("{turn: {angle: 1, to: door}}", "one-of", "'angle' or 'to', not both"),
        ("{turn: {angle: $a, to: door}}", "one-of", "not both"),
        ("{turn: 300 deg}", "wrong-value", "at least -4 and at most 4 rad"),
    ],
)
def test_none_or_several_of_the_inputs(node: str, code: str, words: str) -> None:
    found = problems(node)
    assert [p.code for p in found] == [code]
    assert words in found[0].message


def test_a_skill_that_declares_what_cannot_be() -> None:
    with pytest.raises(TypeError, match="the default is not at least 1"):
        type("Bad", (Skill,), _body(In(0, doc="n", least=1)))
    with pytest.raises(TypeError, match="least=2 is more than most=1"):
        In(doc="n", least=2, most=1)
    with pytest.raises(TypeError, match=r"one_of: n: no input with a default"):
        type("Bad", (Skill,), {**_body(In(doc="n")), "one_of": (("n",),)})


def _body(port: object) -> dict[str, object]:
    return {"__module__": __name__, "__annotations__": {"n": int}, "n": port}


@pytest.mark.parametrize(
    ("node", "message"),
    [
        ("wait: 1e12 s", "at least 0 and at most 1e+07 s"),
        ("wait: {msec: 100000000000}", "at least 0 and at most 1e+10"),
        (
            "distance_controller: {distance: 90000 m, child: succeed}",
            "at least 0 and at most 10000 m",
        ),
        ("speed_controller: {max_speed: 90, child: succeed}", "did you mean 90 cm/s?"),
        ("rate_controller: {hz: 1e9, child: succeed}", "at most 10000 Hz"),
        ("is_within_path_tracking_bounds: {max_error_heading: 90}", "did you mean 90 deg?"),
    ],
)
def test_what_no_robot_can_be_asked_for(check: Check, node: str, message: str) -> None:
    text = f"momantu_bt: 1\ntrees:\n  Main:\n    - {node}\n"
    wrong = [p for p in check(text) if p.severity.label == "error"]
    assert [p.code for p in wrong] == ["wrong-value"]
    assert message in wrong[0].message
    if "{" not in node:
        key = text.replace("trees:", "values: {t: 1e12 s}\ntrees:").replace("1e12 s\n", "$t\n")
        assert [p.code for p in check(key) if p.severity.label == "error"] == ["wrong-value"]
