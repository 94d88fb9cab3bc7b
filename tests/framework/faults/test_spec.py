"""How faults are written: every one of them, wrong ones, and phases against trees."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.activity import Activity
from momantu_bt.engine.build import skills_in
from momantu_bt.failure import CODE, ENGINE_CODES
from momantu_bt.fault import Fault, FaultError
from momantu_bt.fault_kind import FOR
from momantu_bt.faults.kinds.catalogue import kinds
from momantu_bt.faults.matrix import ENDED, RECOVERED, row_of, rows, rows_like
from momantu_bt.faults.phase import Phase, parse_phase
from momantu_bt.faults.phases import check_phase, usual_phase
from momantu_bt.faults.spec import format_fault, parse_fault
from momantu_bt.skill import In, Out, Run, Skill
from momantu_bt.tree.load import load
from momantu_bt.tree.plugins import SKILLS
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution

NOTHING = Substitution()


@st.composite
def faults(draw) -> Fault:
    """Any fault with any parameters within their bounds."""
    kind = kinds()[draw(st.sampled_from(sorted(kinds())))]
    found = dict(kind.defaults)
    for port in kind.parameters:
        if port.type is str:
            value = draw(st.sampled_from(["", "table_a", "shoulder"]))
        elif port.type is int:
            value = draw(st.integers(int(port.least or 0), 99))
        else:
            low = -1e3 if port.least is None else port.least
            high = 1e3 if port.most is None else port.most
            value = draw(st.floats(low, high))
            value = draw(st.sampled_from([value, math.inf])) if port.name == FOR else value
        found[port.name] = draw(st.sampled_from([value, port.default]))
    phase = draw(st.sampled_from([None, "start", "12.5 s", "Put/navigate#2+3 s", "after-pick"]))
    return Fault(kind.component, kind.mode, phase, found)


@given(faults())
def test_what_is_written_is_read_again_as_the_same_fault(fault):
    again = parse_fault(format_fault(fault))
    assert again == fault
    assert list(again.parameters) == [port.name for port in kinds()[fault.name].parameters]


def test_units_and_defaults():
    fault = parse_fault("camera.shifted@pick : turn = 2 deg , for=1 min 30 s")
    assert fault.phase == "pick"
    assert fault.parameters == {"turn": pytest.approx(math.radians(2)), "for": 90.0}
    assert parse_fault("camera.shifted").parameters["for"] == math.inf
    assert format_fault(parse_fault("camera.dead:for=5000 ms")) == "camera.dead"


@pytest.mark.parametrize(
    ("text", "at", "said"),
    [
        ("camra.dead", "camra", "did you mean camera?"),
        ("camera.ded@x", "ded", "did you mean dead?"),
        ("camera.x", "x", "modes of camera: dead, frozen"),
        ("camera", "", "modes of camera: dead"),
        ("dead", "dead", "did you mean camera.dead or laser.dead?"),
        ("", "", "components: camera"),
        ("camera.dead:fro=3", "fro", "did you mean for?"),
        ("gripper.slips:for=3", "for", "no parameter 'for'; did you mean force?"),
        ("process.killed:a=3", "a", "it takes none"),
        ("camera.dead:for", "for", "a number in s, at least 0: how long it lasts"),
        ("camera.dead:for=3 m", "3 m", "expected a time, in: ms, s, min, h"),
        ("camera.dead:for=-1", "-1", "expected at least 0 s"),
        ("camera.dead:for=nan", "nan", "expected number in s"),
        ("camera.dark:gain=3", "3", "at least 0 and at most 1"),
        ("skill.hang:times=1.5", "1.5", "not a whole number"),
        ("tag.wrong_id:id=3,id=4", "id=4", "given twice"),
        ("camera.dead@", "", "expected start, 12 s, NAME"),
        ("camera.dead@a//b", "a//b", "expected start, 12 s, NAME"),
        ("camera.dead@pick#0", "pick#0", "whole number from 1"),
        ("camera.dead@pick+3", "pick+3", "such as +3 s"),
        ("camera.dead@start#2", "start#2", "comes once"),
        ("camera.dead@12 parsec", "12 parsec", "unknown unit"),
    ],
)
def test_a_wrong_fault_is_shown_with_a_caret_and_what_is_valid(text, at, said):
    with pytest.raises(FaultError) as caught:
        parse_fault(text)
    _, shown, marked = str(caught.value).split("\n")
    assert shown == f"  {text}"
    assert said in marked
    begin = marked.index("^") - 2
    assert text[begin : begin + marked.count("^")] == at or (not at and marked.count("^") == 1)


def test_names_are_unique_and_every_row_can_be_judged():
    assert len(rows()) == len({row.fault for row in rows()})
    known = set(ENGINE_CODES)
    for name in SKILLS:
        known |= set(SKILLS.load(name).failures)
    for row in rows():
        assert row.notice > 0.0
        assert row.reasons <= known, f"{row.fault}: {row.reasons - known}"
        assert all(CODE.fullmatch(code) for code in row.reasons)
        assert row.must_end in (RECOVERED, ENDED) or row.must_end == row.reasons != frozenset()
        assert row.kind.doc.endswith(".")
        assert all(port.doc and port.name.isidentifier() for port in row.kind.parameters)


def test_a_fault_belongs_to_the_row_whose_parameters_it_has():
    for row in rows():
        assert row_of(parse_fault(row.fault)).recoverable is row.recoverable
    assert row_of(parse_fault("camera.dead@12 s:for=7 s")).recoverable
    assert not row_of(parse_fault("camera.dead@12 s:for=inf")).recoverable
    assert not row_of(parse_fault("map.wrong:missing=0,shift=0.5")).recoverable
    assert row_of(parse_fault("map.wrong:shift=0.5")).recoverable


def test_rows_by_pattern():
    assert rows_like("all") == rows()
    assert {r.kind.name for r in rows_like("camera.d*, skill.nan")} == {
        "camera.dead",
        "camera.dark",
        "skill.nan",
    }
    with pytest.raises(FaultError, match=r"did you mean camera\.dead"):
        rows_like("camera.ded")
    with pytest.raises(FaultError, match=r"laser\.\* are laser.dead, laser.stuck, laser.blocked"):
        rows_like("camera.dead, laser")


@pytest.mark.parametrize(
    ("text", "phase"),
    [
        ("start", Phase()),
        ("start+2 s", Phase(delay=2.0)),
        ("1 min 5 s", Phase(delay=65.0)),
        ("pick", Phase(("pick",))),
        ("Put / navigate#2", Phase(("Put", "navigate"), count=2)),
        ("after-Put/pick+500 ms", Phase(("Put", "pick"), after=True, delay=0.5)),
        ("after-pick#3+1 s", Phase(("pick",), True, 3, 1.0)),
    ],
)
def test_phases(text, phase):
    assert parse_phase(text) == phase


class Pick(Skill):
    """Takes something."""

    strength: float = In(1.0, doc="how much")
    activities = {Activity.GRASP: "", Activity.REACH: "/reaching"}

    def run(self, robot) -> Run:
        yield "closing"


class Detect(Skill):
    """Sees something."""

    seen: bool = Out(doc="whether")

    def run(self, robot) -> Run:
        yield "looking"


TREE = """
momantu_bt: 1
main: Main
trees:
  Main:
    - Take
    - recover:
        attempts: 2
        try: Put
        catch: {any: {detect: {seen: $seen}}}
    - {wait: 1 s, disabled: true, name: never}
  Take: [pick]
  Put: {sequence: [{wait: 1 s, name: a while}, pick], name: inner}
"""


@pytest.fixture(scope="module")
def document(tmp_path_factory):
    file = tmp_path_factory.mktemp("trees") / "tree.yaml"
    file.write_text(TREE)
    return load(str(file), Registry(skills={"pick": Pick, "detect": Detect})).document


@pytest.mark.parametrize(
    "text",
    [
        "start",
        "3 s",
        "pick",
        "Put/pick",
        "Main/inner/pick#7",
        "after-a while",
        "recover/Put",
        "pick/closing",
        "Put/pick/closing",
        "Main",
        "after-detect",
        "p*/pick",
        "Main/Put/wait",
    ],
)
def test_phases_that_the_tree_has(document, text):
    assert check_phase(text, document, NOTHING) == parse_phase(text)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("pik", "did you mean pick?"),
        ("never", "no node that runs is called 'never'"),
        ("Take/detect", "no detect inside of Take"),
        ("wait/Put", "no Put inside of wait"),
        ("Pt/pick", "did you mean Put?"),
        ("Put/closing", "stands behind the skill's name"),
        ("after-pick/closing", "no node that runs is called 'closing'"),
    ],
)
def test_phases_that_the_tree_has_not(document, text, said):
    with pytest.raises(FaultError) as caught:
        check_phase(text, document, NOTHING)
    assert said in str(caught.value)


def test_usual_phases_fall_back(document):
    def usual(name, skills):
        return usual_phase(kinds()[name], document, skills, NOTHING)

    both = {"pick": Pick, "detect": Detect}
    assert usual("skill.hang", both) == "pick"
    assert usual("skill.nan", both) == "detect"
    assert usual("skill.nan", {"pick": Pick}) == "start"
    assert usual("gripper.slips", both) == "after-pick+3 s"
    assert usual("arm.stuck", both) == "pick/reaching"
    assert usual("laser.dead", both) == "start"
    assert all(check_phase(usual(n, both), document, NOTHING) for n in kinds())


def test_every_usual_phase_is_one_that_the_bundled_tree_has():
    document = load("bring_object", Registry.installed()).document
    skills = {name: SKILLS.load(name) for name in skills_in(document)}
    for kind in kinds().values():
        phase = usual_phase(kind, document, skills, NOTHING)
        assert (phase == "start") is (not kind.begins)
