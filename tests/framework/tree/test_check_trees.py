"""How trees call each other, what runs side by side, and what handlers can meet."""

from collections.abc import Callable

import pytest

from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.tree.check.trees import MAX_NESTING

Expect = Callable[..., None]
Fine = Callable[[str], None]
Check = Callable[[str], list[Problem]]


def test_a_tree_that_runs_itself(expect: Expect) -> None:
    body = "trees:\n  Main: [Sub]\n  Sub: [relocalize, «Main»]\n"
    expect("recursion", body, message="Main -> Sub -> Main")


def test_a_tree_that_nothing_runs_is_a_warning(check: Check) -> None:
    text = "momantu_bt: 1\nmain: Main\ntrees:\n  Main: [{wait: 1}]\n  Sub: [{wait: 1}]\n"
    assert [(p.code, p.severity) for p in check(text)] == [("unused-tree", Severity.WARNING)]


def test_a_tree_named_like_a_skill(expect: Expect) -> None:
    expect("bad-name", "trees:\n  Main: [pick: {}]\n  «pick»: [{wait: 1}]\n")


def test_two_nodes_of_one_name(expect: Expect) -> None:
    body = "trees:\n  Main:\n    - {wait: 1, name: a}\n    - {«wait»: 2, name: a}\n"
    expect("duplicate-name", body, hint="line 6")


def test_overlapping_uses_side_by_side(expect: Expect) -> None:
    body = "trees:\n  Main:\n    parallel:\n      - reset_pose: home\n      - «reset_pose»: carry\n"
    expect("overlapping-uses", body, message="both use arm")


def test_overlapping_uses_inside_subtrees(expect: Expect) -> None:
    body = (
        "trees:\n  Main:\n    parallel_all:\n      - Drive\n      - «sequence»: [relocalize]\n"
        "  Drive: [navigate: door]\n"
    )
    expect("overlapping-uses", body, message="both use base")


def test_different_actuators_side_by_side(fine: Fine) -> None:
    fine("trees:\n  Main:\n    parallel: [{reset_pose: home}, {navigate: door}]\n")


def test_a_handler_for_a_code_that_cannot_arrive(expect: Expect) -> None:
    body = (
        "trees:\n  Main:\n    recover:\n      attempts: 2\n      try: {reset_pose: home}\n"
        "      catch:\n        «GRASP_MISSED»: again\n"
    )
    expect("dead-handler", body, hint="it can fail with: NO_PLAN")


def test_a_mistyped_code(expect: Expect) -> None:
    body = (
        "trees:\n  Main:\n    recover:\n      attempts: 2\n      try: {reset_pose: home}\n"
        "      catch: {«NO_PLANS»: again}\n"
    )
    expect("dead-handler", body, hint="did you mean NO_PLAN?")


def test_a_code_that_comes_through_a_subtree(fine: Fine) -> None:
    fine(
        "trees:\n  Main:\n    recover:\n      attempts: 2\n      try: Sub\n"
        "      catch: {NO_PLAN: again, reset_pose.SKILL_ERROR: again, TIMEOUT | MINE: again}\n"
        "  Sub:\n    - {reset_pose: home, timeout: 3 s}\n    - fail: MINE\n"
    )


def test_a_code_that_a_handler_has_taken_away(expect: Expect) -> None:
    body = (
        "trees:\n  Main:\n    recover:\n      attempts: 2\n"
        "      try: {handle: {try: {reset_pose: home}, catch: {NO_PLAN: relocalize}}}\n"
        "      catch: {«NO_PLAN»: again, NOT_LOCALIZED: again}\n"
    )
    expect("dead-handler", body)


def test_a_code_that_else_fail_gives(fine: Fine, expect: Expect) -> None:
    body = (
        "values: {battery: 30}\ntrees:\n  Main:\n    recover:\n      attempts: 2\n"
        "      try:\n        - condition: $battery > 20\n          else_fail: BATTERY_LOW\n"
        "        - reset_pose: home\n          else_fail: STUCK\n"
        "      catch: {BATTERY_LOW: again, STUCK: again%s}\n"
    )
    fine(body % "")
    expect("dead-handler", body % ", «NO_PLAN»: again")


def test_else_fail_around_what_cannot_fail(expect: Expect) -> None:
    body = (
        "trees:\n  Main:\n    handle:\n      try: {force_success: {child: relocalize}, "
        "else_fail: STUCK}\n      catch: {«STUCK»: relocalize}\n"
    )
    expect("dead-handler", body, hint="it can fail with: nothing")


def test_else_fail_wants_a_code(expect: Expect) -> None:
    expect("bad-code", "trees:\n  Main: [{relocalize: , else_fail: «stuck»}]\n")
    expect("missing-input", "trees:\n  Main: [{relocalize: , «else_fail»: }]\n")


def test_the_codes_of_a_question(fine: Fine, expect: Expect) -> None:
    body = (
        "trees:\n  Main:\n    recover:\n      attempts: 2\n"
        "      try: [{%s}]\n      catch: {NO_ANSWER: again, %s: again}\n"
    )
    fine(body % ("confirm: Well?", "DECLINED"))
    expect("dead-handler", body % ("ask: {question: Well?, answer: $@a}", "«DECLINED»"))


def test_two_handlers_for_one_code(expect: Expect) -> None:
    body = (
        "trees:\n  Main:\n    recover:\n      attempts: 2\n      try: {reset_pose: home}\n"
        "      catch:\n        NO_PLAN: again\n        any | «NO_PLAN»: relocalize\n"
    )
    expect("dead-handler", body, hint="in line 10")


def test_a_code_of_a_node_type_that_does_not_raise_it(expect: Expect) -> None:
    body = (
        "trees:\n  Main:\n    recover:\n      attempts: 2\n      try:\n"
        "        - reset_pose: home\n        - relocalize\n"
        "      catch: {«relocalize.NO_PLAN»: again}\n"
    )
    expect("dead-handler", body, message="fails with relocalize.NO_PLAN")


def test_again_in_handle(expect: Expect) -> None:
    body = "trees:\n  Main: [{handle: {try: relocalize, catch: {any: «again»}}}]\n"
    expect("again", body)


def test_unknown_world(check: Check) -> None:
    text = "momantu_bt: 1\nworld: room\ntrees:\n  Main: [{wait: 1}]\n"
    (problem,) = check(text)
    assert (problem.code, problem.place.line, problem.place.column) == ("unknown-world", 2, 8)
    assert problem.hint == "did you mean rooms?"


def test_every_error_is_reported_at_once(check: Check) -> None:
    text = (
        "momantu_bt: 1\nworld: roms\nmain: Mian\ntrees:\n  Main:\n    - pik: $it\n"
        "    - navigate: {side: x, sid: 1}\n    - wait: 3 m\n"
    )
    codes = [problem.code for problem in check(text)]
    assert codes == [
        "unknown-world",
        "unknown-tree",
        "unknown-node",
        "wrong-value",
        "unknown-port",
        "wrong-value",
    ]


def test_too_many_nodes_within_nodes(check: Check) -> None:
    modifiers = "".join(f", {m}: 2" for m in ("retry", "repeat", "timeout", "delay"))
    node = "{wait: 1" + modifiers + "}"
    for _ in range(MAX_NESTING // 5):
        node = "{sequence: [" + node + "]" + modifiers + "}"
    assert [p.code for p in check(f"momantu_bt: 1\ntrees:\n  Main: {node}\n")] == ["too-large"]


def _passed_on(outer: str, inner: str = "NO_PLAN | TIMEOUT", code: str = "$failure.code") -> str:
    return (
        "trees:\n  Main:\n    handle:\n      try: Sub\n      catch:\n"
        f"        {outer}: relocalize\n"
        "  Sub:\n    recover:\n      attempts: 2\n      try: {reset_pose: home, timeout: 3 s}\n"
        f"      catch:\n        {inner}: {{fail: {{code: {code}}}}}\n"
    )


def test_a_code_that_a_handler_passes_on_can_arrive(fine: Fine, expect: Expect) -> None:
    fine(_passed_on("NO_PLAN | TIMEOUT"))
    expect("dead-handler", _passed_on("NO_PLAN | «TIME_OUT»"), hint="did you mean TIMEOUT?")
    expect("dead-handler", _passed_on("«MINE»"))
    fine(_passed_on("MINE", code="MINE"))


def test_a_handler_of_the_rest_can_pass_on_anything(fine: Fine) -> None:
    fine(_passed_on("NO_PLAN | WHATEVER", inner="any"))


def test_the_code_of_a_node_type_is_passed_on_bare(fine: Fine) -> None:
    fine(_passed_on("NO_PLAN", inner="reset_pose.NO_PLAN"))


OUT = "Sub:\n  inputs: {a: text}\n"


@pytest.mark.parametrize(
    ("slip", "code", "line", "hint"),
    [
        (
            ("  Sub:\n    inputs: {a: text}\n  ", "Sub:\n  inputs: {a: text}\n"),
            "unknown-key",
            8,
            "trees",
        ),
        (("trees:\n  Main", "tress:\n  Main"), "unknown-key", 4, "did you mean trees?"),
    ],
)
def test_one_wrong_indentation_is_one_error(
    check: Callable[[str], list[Problem]], slip: tuple[str, str], code: str, line: int, hint: str
) -> None:
    text = (
        "momantu_bt: 1\nworld: rooms\nmain: Main\ntrees:\n  Main:\n    - Sub: {a: x}\n"
        "    - Sub: {a: y}\n  Sub:\n    inputs: {a: text}\n    say: $a\n"
    )
    (problem,) = check(text.replace(*slip))
    assert (problem.code, problem.place.line) == (code, line)
    assert hint in problem.hint
