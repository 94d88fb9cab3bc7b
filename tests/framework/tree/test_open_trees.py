"""Trees that declare no ports, and keys that go in and out: what is known of them, and where."""

from collections.abc import Callable

import pytest

from momantu_bt.formats.problems import Problem, Severity

Check = Callable[[str], list[Problem]]


def files(main: str, sub: str, other: str = "<AlwaysSuccess/>", model: str = "") -> str:
    return (
        '<root BTCPP_format="4" main_tree_to_execute="Main" xmlns:momantu="urn:momantu-bt:1">\n'
        f'<BehaviorTree ID="Main"><Sequence>\n{main}\n</Sequence></BehaviorTree>\n'
        f'<BehaviorTree ID="Sub">\n{sub}\n</BehaviorTree>\n'
        f'<BehaviorTree ID="Other">\n{other}\n</BehaviorTree>\n'
        f"<TreeNodesModel>{model}</TreeNodesModel></root>"
    )


USE_OTHER = '<SubTree ID="Other"/>'
SET = '<Script code="x := 1"/>'
READS = '<ScriptCondition code="k &gt; 1"/>'
MAYBE = '<ForceSuccess><Sequence><AlwaysFailure/><Script code="k := 2"/></Sequence></ForceSuccess>'
WRITES = '<Script code="k := 2"/>'


def shown(found: list[Problem]) -> list[tuple[str, str, int]]:
    return [(p.code, p.severity.name.lower(), p.place.line) for p in found]


@pytest.mark.parametrize(
    ("main", "sub", "expected"),
    [
        # what a tree inside reads, whoever runs it must give
        (SET + '<SubTree ID="Sub" k="{x}"/>', READS, []),
        ('<SubTree ID="Sub" k="{x}"/>', READS, [("error", 3)]),
        ('<SubTree ID="Sub" k="3"/>', READS, []),
        ('<SubTree ID="Sub"/>', READS, [("error", 6)]),
        ('<SubTree ID="Sub"/>', f"<Sequence>{MAYBE}{READS}</Sequence>", [("warning", 6)]),
        (SET.replace("x", "k") + '<SubTree ID="Sub" _autoremap="true"/>', READS, []),
        ('<SubTree ID="Sub" _autoremap="true"/>', READS, [("error", 3)]),
        (f'<SubTree ID="Sub" _autoremap="true"/>{WRITES}', READS, [("warning", 3)]),
        # what it writes is known after it
        (f'<SubTree ID="Sub" k="{{x}}"/>{READS.replace("k", "x")}', WRITES, []),
        (f'<SubTree ID="Sub" _autoremap="1"/>{READS}', WRITES, []),
        (f'<SubTree ID="Sub"/>{READS}', WRITES, [("error", 3)]),
        (
            f'<SubTree ID="Sub" k="{{x}}"/>{READS.replace("k", "x")}',
            f"<Fallback><AlwaysFailure/>{WRITES}</Fallback>",
            [],
        ),
        (
            f'<SubTree ID="Sub" k="{{x}}"/>{READS.replace("k", "x")}',
            '<ForceSuccess><ScriptCondition code="1" _onFailure="k := 1"/></ForceSuccess>',
            [("warning", 3)],
        ),
        # what it takes away is not
        (
            f'{SET}<SubTree ID="Sub" k="{{x}}"/>{READS.replace("k", "x")}',
            '<UnsetBlackboard key="k"/>',
            [("warning", 3)],
        ),
        # keys inside are its own
        ('<SubTree ID="Sub" k="{k}"/>', WRITES, []),
        (
            f"{WRITES}<SubTree ID=\"Sub\" _autoremap='true'/>",
            READS.replace("k", "_k"),
            [("error", 6)],
        ),
    ],
)
def test_keys_that_a_tree_shares(
    main: str, sub: str, expected: list[tuple[str, int]], check: Check
) -> None:
    found = [p for p in check(files(USE_OTHER + main, sub)) if p.code == "read-before-write"]
    wanted = [("read-before-write", severity, line) for severity, line in expected]
    assert shown(found) == wanted


def test_through_two_trees(check: Check) -> None:
    for given, wanted in (("{x}", []), ("{y}", [("read-before-write", "error", 3)])):
        main = SET + f'<SubTree ID="Sub" a="{given}"/>'
        sub = '<SubTree ID="Other" k="{a}"/>'
        assert shown(check(files(main, sub, READS))) == wanted
    remapped = '<SubTree ID="Other" _autoremap="true"/>'
    assert check(files(WRITES + '<SubTree ID="Sub" _autoremap="true"/>', remapped, READS)) == []


def test_an_attribute_that_is_never_mentioned(check: Check) -> None:
    main = USE_OTHER + SET + '<SubTree ID="Sub" k="{x}" kk="{x}"/>'
    (problem,) = check(files(main, READS))
    assert (problem.code, problem.severity) == ("unused-port", Severity.WARNING)
    assert (problem.place.line, problem.place.length) == (3, 2)
    assert "did you mean k?" in problem.hint
    deeper = '<SubTree ID="Other" _autoremap="true"/>'
    main = SET + '<SubTree ID="Sub" k="{x}"/>'
    assert check(files(main, deeper, READS)) == []


def test_a_model_closes_the_tree(check: Check) -> None:
    model = '<SubTree ID="Sub"><inout_port name="k" type="int"/></SubTree>'
    main = USE_OTHER + SET + '<SubTree ID="Sub" {}="{{x}}"/>'
    assert check(files(main.format("k"), READS, model=model)) == []
    (problem,) = check(files(main.format("kk"), WRITES, model=model))
    assert (problem.code, problem.hint) == ("unknown-port", "did you mean k?")
    needed = model.replace("inout_port", "input_port")
    (problem,) = check(files(USE_OTHER + '<SubTree ID="Sub"/>', READS, model=needed))
    assert problem.code == "missing-input"
    remapped = USE_OTHER + WRITES + '<SubTree ID="Sub" _autoremap="true"/>'
    assert check(files(remapped, READS, model=needed)) == []


def test_a_default_that_is_a_key(check: Check) -> None:
    model = '<SubTree ID="Sub"><inout_port name="k" default="{x}"/></SubTree>'
    main = USE_OTHER + '{}<SubTree ID="Sub"/>'
    assert check(files(main.format(SET), READS, model=model)) == []
    assert shown(check(files(main.format(""), READS, model=model))) == [
        ("read-before-write", "error", 3)
    ]


def test_types_of_what_is_shared(check: Check) -> None:
    model = '<SubTree ID="Sub"><inout_port name="k" type="pose"/></SubTree>'
    main = USE_OTHER + '<SetBlackboard output_key="x" value="5"/><SubTree ID="Sub" k="{x}"/>'
    (problem,) = check(files(main, '<navigate within_reach_of="{k}"/>', model=model))
    assert (problem.code, problem.message[:8]) == ("wrong-type", "{x} is i")


def test_inouts_in_yaml(check: Check) -> None:
    body = (
        "momantu_bt: 1\nmain: Main\ntrees:\n  Main:\n    - {first}\n    - Sub: {{n: $m}}\n"
        "    - condition: $m > 1\n  Sub:\n    inouts: {{n: int}}\n    script: {inner}\n"
    )
    write = "script: $m := 1"
    assert check(body.format(first=write, inner="$n += 1")) == []
    assert check(body.format(first="wait: 1 s", inner="$n := 1")) == []
    (problem,) = check(body.format(first="wait: 1 s", inner="$n += 1"))
    assert (problem.code, problem.place.line) == ("read-before-write", 6)


def test_an_open_tree_in_yaml_takes_any_key(check: Check) -> None:
    body = (
        "momantu_bt: 1\nmain: Main\ntrees:\n  Main:\n    - script: $m := 1\n"
        "    - Sub: {n: $m, o: 5}\n  Sub:\n    open: true\n    condition: $n + $o > 2\n"
    )
    assert check(body) == []


def test_given_names_may_stand_twice_where_the_dialect_allows_it(check: Check) -> None:
    twice = '<AlwaysSuccess name="a"/><AlwaysSuccess name="a"/>'
    sub = '<SubTree ID="Sub"/>'
    found = check(files(USE_OTHER + sub + twice, "<AlwaysSuccess/>"))
    assert shown(found) == [("duplicate-name", "warning", 3)]
    model = '<SubTree ID="Main"/>'
    found = check(files(USE_OTHER + sub + twice, "<AlwaysSuccess/>", model=model))
    assert shown(found) == [("duplicate-name", "warning", 3)]


def test_an_enum_of_a_program_is_told_by_its_name(check: Check) -> None:
    text = (
        '<root BTCPP_format="4"><BehaviorTree ID="Main"><Sequence><Script code="color := 1"/>'
        '<ScriptCondition code="color == RED"/></Sequence></BehaviorTree></root>'
    )
    (problem,) = check(text)
    assert problem.code == "read-before-write"
    assert "RED is an enum of a C++ program" in problem.hint
