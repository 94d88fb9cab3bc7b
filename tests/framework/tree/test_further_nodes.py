"""Switches, queues, watched keys and Nav2's nodes in YAML: what they become, what is refused."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.tree.catalogue import NODES, SWITCHES
from momantu_bt.tree.files.xml.format import read as read_xml
from momantu_bt.tree.files.xml.writer import write as write_xml
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.model import Literal, Reference, Scope

Check = Callable[[str], list[Problem]]

ADVICE = ("unused-value", "unreachable")


@pytest.mark.parametrize("count", sorted(SWITCHES))
def test_a_switch_has_as_many_cases_as_are_written(count: int) -> None:
    cases = ", ".join(f"{index}: relocalize" for index in range(count))
    text = _tree(f"{{switch: $n, cases: {{{cases}}}, default: relocalize}}")
    document, _ = read(text, "t.yaml")
    node = document.trees["Main"].root.children[0]
    assert node.type == f"Switch{count}"
    assert node.ports["variable"] == Reference("n")
    assert [node.ports[f"case_{i + 1}"] for i in range(count)] == [*map(Literal, range(count))]
    assert len(node.children) == count + 1


@pytest.mark.parametrize(
    ("node", "code"),
    [
        ("{switch: $n, cases: {1: relocalize, 2: relocalize}}", "missing-child"),
        ("{switch: $n, default: relocalize}", "missing-child"),
        ("{switch: $n, cases: {1: relocalize}, default: relocalize}", "wrong-value"),
        ("{switch: $n, cases: [relocalize, relocalize], default: relocalize}", "wrong-value"),
        (
            "{switch: $n, cases: {1: relocalize, 1: relocalize}, default: relocalize}",
            "duplicate-key",
        ),
        (
            "{switch: $m, cases: {1: relocalize, 2: relocalize}, default: relocalize}",
            "read-before-write",
        ),
        (
            "{switch: $n, cases: {1: relocalise, 2: relocalize}, default: relocalize}",
            "unknown-node",
        ),
        ("{try_catch: [relocalize]}", "children"),
        (
            "{try_catch: {catch_on_halt: perhaps, children: [relocalize, relocalize]}}",
            "wrong-value",
        ),
        ("{recovery_node: [relocalize, relocalize, relocalize]}", "children"),
        ("{loop_int: {queue: 1;x, value: $v, child: relocalize}}", "wrong-value"),
        ("{loop_bool: {queue: [1], child: relocalize}}", "wrong-value"),
        ("{loop_int: {value: $v, child: relocalize}}", "missing-input"),
        ("{loop_int: {queue: 1, if_empty: RUNNING, child: relocalize}}", "wrong-value"),
        ("{loop_int: {queue: $flags, child: relocalize}}", "wrong-value"),
        ("{relocalize: , skip_unless_updated: k}", "not-a-key"),
        ("{relocalize: , skip_unless_updated: $n.part}", "not-a-key"),
        ("{relocalize: , skip_unless_updated: $nn}", "read-before-write"),
        ("{was_entry_updated: }", "missing-input"),
        ("{was_entry_updated: $nobody}", "read-before-write"),
        ("{goal_updated: {goal: $nobody}}", "read-before-write"),
        ("{relocalize: , rate_controller: often}", "wrong-value"),
        ("{relocalize: , rate_controller: 1 m}", "wrong-value"),
        ("{persistent_sequence: [relocalize]}", "missing-input"),
        ("{persistent_sequence: {current_child_idx: 0, children: [relocalize]}}", "not-a-key"),
        ("{test_node: {return_status: IDLE}}", "wrong-value"),
        ("{test_node: {code: oh no, return_status: FAILURE}}", "bad-code"),
        ("{test_node: {success_script: $n +}}", "script"),
    ],
)
def test_what_is_refused(check: Check, node: str, code: str) -> None:
    found = check(_tree(node))
    assert [problem.code for problem in found if problem.severity is Severity.ERROR] == [code]


@pytest.mark.parametrize(
    "node",
    [
        "{switch: $n, cases: {red: relocalize, 2.5: relocalize}, default: [relocalize]}",
        "{try_catch: {catch_on_halt: true, children: [relocalize, relocalize]}}",
        "{loop_int: {queue: 1;2;3, value: $v, child: {script: $n = $v + 1}}}",
        "{loop_number: {queue: [1, 2.5], value: $v, child: {script: $n = $v + 1}}}",
        "{loop_text: {queue: a;b, value: $v, if_empty: SKIPPED, child: {say: $v}}}",
        "{loop_bool: {queue: true;0, child: relocalize}}",
        "{loop_int: {queue: $n, child: relocalize}}",
        "{relocalize: , skip_unless_updated: $n}",
        "{wait_value_update: {entry: $n, child: relocalize}}",
        "{fallback: [{was_entry_updated: $n}, relocalize]}",
        "{recovery_node: {number_of_retries: 6, children: [relocalize, relocalize]}}",
        "{pipeline_sequence: [{relocalize: , rate_controller: 1 Hz}, {say: hi}]}",
        "{nonblocking_sequence: [relocalize, succeed]}",
        "[{script: $i := 0}, {persistent_sequence: {current_child_idx: $i, children: [succeed]}}]",
        "{round_robin: {wrap_around: false, children: [relocalize, relocalize]}}",
        "{relocalize: , distance_controller: 50 cm}",
        "{relocalize: , speed_controller: {min_rate: 0.5, max_speed: 80 cm/s}}",
        "{relocalize: , single_trigger: }",
        "{relocalize: , goal_updated_controller: }",
        "{reactive_fallback: [goal_updated, relocalize]}",
        "{goal_updater: {input_goal: $n, output_goal: $g, child: {script: $n = $g + 1}}}",
        "{test_node: {return_status: FAILURE, code: NO_WAY, async_delay: 1 s}}",
        "[{test_node: {success_script: '$r := 1'}}, {script: $n = $r}]",
    ],
)
def test_what_is_accepted(check: Check, node: str) -> None:
    assert [p for p in check(_tree(node)) if p.code not in ADVICE] == []


@pytest.mark.parametrize(
    "node",
    [
        "{for_each: {in: [1], as: $v, child: relocalize}}",
        "{loop_int: {queue: $n, value: $v, child: relocalize}}",
        "{skip_unless_updated: {entry: $n, child: {script: '$v := 1'}}}",
        "{switch: $n, cases: {1: {script: '$v := 1'}, 2: {script: '$v := 2'}}, default: succeed}",
        "{try_catch: [{fallback: [relocalize, {script: '$v := 1'}]}, relocalize]}",
        "{pipeline_sequence: [{fallback: [relocalize, {script: '$v := 1'}]}]}",
        "{path_longer_on_approach: {path: [], child: {script: '$v := 1'}}}",
        "{goal_updater: {output_goal: $v, child: relocalize}}",
        "{test_node: {return_status: SKIPPED, success_script: '$v := 1'}}",
    ],
)
def test_a_key_that_may_have_stayed_empty_is_not_known_afterwards(check: Check, node: str) -> None:
    problems = check(_tree(f"[{node}, {{script: $n = $v}}]"))
    assert "read-before-write" in [problem.code for problem in problems]


@pytest.mark.parametrize(
    "node",
    [
        "{switch: $n, cases: {1: {set: {key: $v, value: 1}}, 2: {script: '$v := 2'}}, "
        "default: {script: '$v := 3'}}",
        "{try_catch: [{script: '$v := 1'}, relocalize]}",
        "{pipeline_sequence: [{script: '$v := 1', rate_controller: 1}, relocalize]}",
        "{nonblocking_sequence: [{script: '$v := 1'}, relocalize]}",
        "{recovery_node: [{script: '$v := 1'}, relocalize]}",
        "{wait_value_update: {entry: $n, child: {script: '$v := 1'}}}",
    ],
)
def test_a_key_that_is_surely_written_is_known_afterwards(check: Check, node: str) -> None:
    found = check(_tree(f"[{node}, {{script: $n = $v}}]"))
    assert [p for p in found if p.code not in ADVICE] == []


def test_a_switch_may_be_written_with_its_ports() -> None:
    ports = "variable: $n, case_1: 1, case_2: $n"
    document, _ = read(
        _tree(f"{{switch: {{{ports}, children: [succeed, fail: A, succeed]}}}}"), "t"
    )
    switch = document.trees["Main"].root.children[0]
    assert switch.type == "Switch2"
    assert switch.ports["case_2"] == Reference("n")


@pytest.mark.parametrize(
    "node",
    [
        '<UnsetBlackboard key="k"/>',
        '<SetBlackboard output_key="k" value="1"/>',
        '<WasEntryUpdated entry="k"/>',
        '<SkipUnlessUpdated entry="k"><AlwaysSuccess/></SkipUnlessUpdated>',
    ],
)
def test_in_xml_a_key_is_also_named_without_braces(node: str) -> None:
    text = f'<root BTCPP_format="4"><BehaviorTree ID="Main">{node}</BehaviorTree></root>'
    document, problems = read_xml(text, "t.xml")
    found = document.trees["Main"].root.ports
    assert problems.sorted() == []
    assert Reference("k") in found.values()
    document, problems = read_xml(text.replace('"k"', '"@k"'), "t.xml")
    assert problems.sorted() == []
    assert Reference("k", scope=Scope.ROOT) in document.trees["Main"].root.ports.values()


def test_nodes_with_a_queue_or_a_watched_key_say_so_in_the_catalogue() -> None:
    for spec in NODES.values():
        assert set(spec.keys) <= set(spec.ports)
        assert set(spec.may_be_empty) <= set(spec.ports)
        assert spec.item is None or set(spec.item) <= set(spec.ports)


def _tree(node: str) -> str:
    return (
        "momantu_bt: 1\nvalues: {n: 1, flags: [true]}\n"
        f"trees:\n  Main:\n    - {node}\n    - {{fallback: [{{condition: $n > 0}}, succeed]}}\n"
    )


@pytest.mark.parametrize(
    "node", ['<UnsetBlackboard key="{n}"/>', '<SetBlackboard output_key="{n}" value="1"/>']
)
def test_in_xml_braces_would_name_another_key(node: str) -> None:
    text = f'<root BTCPP_format="4"><BehaviorTree ID="Main">{node}</BehaviorTree></root>'
    problem = read_xml(text, "t.xml")[1].sorted()[0]
    assert problem.code == "not-a-key"
    assert "would be the key whose name {n} holds" in problem.message
    assert 'key="n"' in problem.hint


def test_xml_names_the_key_that_is_set_without_braces() -> None:
    document, _ = read(_tree("{set: {key: $@n, value: 2}}"), "t.yaml")
    assert '<SetBlackboard output_key="@n" value="2"/>' in write_xml(document)
    assert read_xml(write_xml(document), "t.xml")[0] == document


def test_xml_names_the_key_that_is_unset_without_braces() -> None:
    document, _ = read(_tree("{unset: $n}"), "t.yaml")
    assert '<UnsetBlackboard key="n"/>' in write_xml(document)
    on_root, _ = read(_tree("{unset: $@n}"), "t.yaml")
    assert '<UnsetBlackboard key="@n"/>' in write_xml(on_root)
    assert read_xml(write_xml(on_root), "t.xml")[0] == on_root
    wrong, _ = read(_tree("{unset: n}"), "t.yaml")
    again, _ = read_xml(write_xml(wrong), "t.xml")
    assert again == wrong
