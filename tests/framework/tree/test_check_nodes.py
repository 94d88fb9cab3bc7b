"""Each node by itself: names, ports, values, children; each mistake at its exact place."""

from collections.abc import Callable

import pytest

Expect = Callable[..., None]
Fine = Callable[[str], None]


def main(*lines: str) -> str:
    """A file's `trees:` with one tree `Main` of these lines."""
    return "trees:\n  Main:\n" + "".join(f"    {line}\n" for line in lines)


def test_a_good_tree_has_no_problems(fine: Fine) -> None:
    fine(
        main(
            "- reset_pose: home",
            "- navigate: {in_front_of: table_a, tolerance: 3 cm}",
            "- detect_object: {object: {category: can, height: 12 cm}, on: table_a, found: $it}",
            "- pick: {object: $it, lift: 120 mm}",
            "- navigate: {goal: {x: 1, y: 2.5, yaw: 90 deg}, recovery: false}",
        )
    )


def test_unknown_node(expect: Expect) -> None:
    expect("unknown-node", main("- «navigat»: {side: 1}"), hint="did you mean navigate?")


def test_unknown_node_in_the_other_spelling(expect: Expect) -> None:
    expect("unknown-node", main("- «ReactiveSequence»: []"), hint="did you mean reactive_sequence?")


def test_unknown_node_far_from_any_lists_the_known(expect: Expect) -> None:
    expect("unknown-node", main("- «xyzzy»"), hint="navigate, detect_object")


def test_unknown_port(expect: Expect) -> None:
    expect("unknown-port", main("- navigate: {«sidee»: 1}"), hint="did you mean side?")


def test_a_modifier_among_the_ports(expect: Expect) -> None:
    expect(
        "misplaced-modifier",
        main("- navigate: {side: 1, «retry»: 3}"),
        hint="move `retry` left, under `navigate`",
    )


def test_unknown_modifier(expect: Expect) -> None:
    expect(
        "unknown-modifier",
        main("- navigate: {side: 1}", "  «retyr»: 3"),
        hint="did you mean retry?",
    )


def test_unknown_modifier_written_first(expect: Expect) -> None:
    expect("unknown-modifier", main("- «timeot»: 3 s", "  navigate: {side: 1}"), hint="timeout")


def test_two_nodes_in_one_item(expect: Expect) -> None:
    expect("unknown-modifier", main("- wait: 1 s", "  «sequence»: []"), hint="each node with `- `")


def test_only_modifiers(expect: Expect) -> None:
    expect("no-node", main("- «{retry: 3}»"), message="only modifiers here (retry)")


def test_a_time_is_given_once(expect: Expect) -> None:
    expect("missing-input", main("- «wait»: {}"), message="needs the input 'duration'")
    expect("one-of", main("- wait: {duration: 1 s, «msec»: 1000}"), message="not both")


def test_missing_input(expect: Expect) -> None:
    expect("missing-input", main("- «pick»"), message="'object'", hint="detected_object")


def test_missing_key_of_a_built_in_node(expect: Expect) -> None:
    expect("missing-input", main("- «set»: {value: 3}"), message="'key'")


@pytest.mark.parametrize(
    ("node", "message"),
    [
        ("navigate: {side: «left»}", "expected int"),
        ("navigate: {side: «1.5»}", "not a whole number"),
        ("navigate: {tolerance: «3 s»}", "expected a length, in: mm, cm, m"),
        ("navigate: {tolerance: «3 mmm»}", "did you mean 'mm'"),
        ("navigate: {recovery: «yes»}", "did you mean true?"),
        ("navigate: {recovery: «off»}", "did you mean false?"),
        ("navigate: {goal: «{x: 1, z: 2}»}", "no field 'z'"),
        ("navigate: {goal: «{x: 1}»}", "needs the field 'y'"),
        ("navigate: {within_reach_of: «here»}", "expected pose"),
        ("wait: «5 m»", "expected a time"),
        ("wait: «soon»", "expected number in s"),
        ("say: «12»", 'write "12" in quotes'),
        ("parallel: {success_count: «all», children: [wait: 1, wait: 2]}", "expected int"),
        ("precondition: {if: $@a, else: «MAYBE», child: {wait: 1}}", "FAILURE, SUCCESS"),
    ],
)
def test_wrong_value(expect: Expect, node: str, message: str) -> None:
    values = "values: {a: true}\n"
    expect("wrong-value", values + main(f"- {node}"), message=message)


def test_bare_value_goes_to_the_first_input(fine: Fine, expect: Expect) -> None:
    fine(main("- say: hello", "- navigate: door", "- wait: 1 min 30 s"))
    expect("unknown-port", main("- relocalize: «now»"), message="relocalize has no input")


def test_unknown_place(expect: Expect) -> None:
    expect("unknown-place", main("- navigate: «tabel_a»"), hint="did you mean table_a?")


def test_unknown_surface(expect: Expect) -> None:
    body = main("- detect_object: {object: {category: can}, on: «door»}")
    expect("unknown-surface", body, hint="surfaces: table_a, table_b")


def test_unknown_plugin(expect: Expect, fine: Fine) -> None:
    """An input may name a plug-in of any group; here, what reads world files."""
    fine(main("- save: yaml"))
    expect("unknown-plugin", main("- save: «yamml»"), hint="did you mean yaml?")


def test_unknown_named_pose(expect: Expect) -> None:
    expect("unknown-named-pose", main("- reset_pose: «hom»"), hint="did you mean home?")


def test_an_output_needs_a_key(expect: Expect) -> None:
    body = main("- detect_object: {object: {category: can}, on: table_a, found: «it»}")
    expect("not-a-key", body, hint="did you mean $it?")


def test_an_output_cannot_be_a_part(expect: Expect) -> None:
    body = main("- detect_object: {object: {category: can}, on: table_a, found: «$it.pose»}")
    expect("not-a-key", body, hint="write $it")


def test_braces_are_a_mapping(expect: Expect) -> None:
    expect("braces", main("- navigate: {in_front_of: «{at}»}"), hint="did you mean $at?")
    expect("braces", main("- navigate: «{at}»"), hint="did you mean $at?")


@pytest.mark.parametrize("node", ["sequence", "fallback", "parallel", "round_robin"])
def test_a_control_node_without_children(expect: Expect, node: str) -> None:
    expect("children", main(f"- «{node}»: []"), message="at least 1")


def test_a_decorator_without_a_child(expect: Expect) -> None:
    expect("children", main("- «for_each»: {in: [1], as: $n}"), message="no child")


def test_recover_without_catch(expect: Expect) -> None:
    expect("missing-child", main("- «recover»: {attempts: 2, try: {wait: 1}}"), message="catch")


def test_if_without_then(expect: Expect) -> None:
    expect("missing-child", main("- «if»: {say: a}", "  else: {say: b}"), message="then")


def test_a_default_that_is_no_choice(fine: Fine, expect: Expect) -> None:
    body = (
        "trees:\n  Main:\n    - ask: {question: Which?, choices: [a, b], default: %s, answer: $x}\n"
    )
    body += "    - {condition: $x == 'a'}\n"
    fine(body % "a")
    expect("wrong-value", body % "«c»", message="not among the choices", hint="a, b")


def test_a_bad_code(expect: Expect) -> None:
    expect("bad-code", main("- fail: «notFound»"), hint="such as NOT_FOUND")


def test_text_for_a_number(expect: Expect) -> None:
    values = "values: {n: 3}\n"
    body = values + main('- navigate: {side: «"${n}"»}')
    expect("wrong-type", body, message="is not a text")


def test_again_outside_of_recover(expect: Expect) -> None:
    expect("again", main("- «again»"))


def test_unknown_type_of_an_input(expect: Expect) -> None:
    tree = "trees:\n  Main: [Sub: {n: 1}]\n  Sub:\n    inputs: {n: «integer»}\n    say: hi\n"
    expect("unknown-type", tree, hint="did you mean int?")


def test_wrong_default_of_an_input(expect: Expect) -> None:
    tree = (
        "trees:\n  Main: [Sub]\n  Sub:\n    inputs:\n      n: {type: «int», default: two}\n"
        "    say: hi\n"
    )
    expect("wrong-value", tree, message="the default of 'n'")


def test_a_switch_on_a_written_value(expect: Expect) -> None:
    cases = "{red: succeed, green: succeed}"
    body = f"trees:\n  Main: {{switch: «colour», cases: {cases}, default: succeed}}\n"
    expect("not-a-key", body, message="chooses by a key", hint="write $colour")
