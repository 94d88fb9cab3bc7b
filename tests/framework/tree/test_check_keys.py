"""Keys and wires: what is read has been written on every way there, and fits."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.plugins import PluginError
from momantu_bt.service import Service
from momantu_bt.tree.load import TreeError, load
from momantu_bt.tree.registry import Registry

Expect = Callable[..., None]
Fine = Callable[[str], None]
SEE = "detect_object: {object: {category: can}, on: table_a, found: $it}"


def main(*lines: str, values: str = "") -> str:
    """A file's values and `trees:` with one tree `Main` of these lines."""
    body = "".join(f"    {line}\n" for line in lines)
    return (f"values: {values}\n" if values else "") + "trees:\n  Main:\n" + body


def test_nobody_writes_the_key(expect: Expect) -> None:
    expect("read-before-write", main("- pick: «$it»"), message="nothing writes $it")


def test_a_mistyped_key(expect: Expect) -> None:
    expect("read-before-write", main("- say: «$nam»", values="{name: a}"), hint="name?")


def test_read_before_it_is_written(expect: Expect) -> None:
    expect("read-before-write", main("- pick: «$it»", f"- {SEE}", "- pick: $it"))


def test_written_on_one_way_only(expect: Expect) -> None:
    body = main("- fallback:", f"    - {SEE}", "    - relocalize", "- pick: «$it»")
    expect("read-before-write", body, message="may have no value", hint="(line 7) writes it")


def test_written_on_every_way(fine: Fine) -> None:
    fine(main("- fallback:", f"    - {SEE}", f"    - {SEE}", "- pick: $it"))


def test_if_both_branches_write_it(fine: Fine) -> None:
    fine(
        main(
            "- if: $n > 2",
            f"  then: {{{SEE}}}",
            f"  else: {{{SEE}}}",
            "- pick: $it",
            values="{n: 3}",
        )
    )


def test_if_without_else_fails_when_it_does_not_hold(fine: Fine) -> None:
    fine(main("- if: $n > 2", f"  then: {{{SEE}}}", "- pick: $it", values="{n: 3}"))


def test_a_skipped_node_may_not_have_written(expect: Expect) -> None:
    body = main(f"- {SEE}", "  skip_if: $n > 2", "- pick: «$it»", values="{n: 3}")
    expect("read-before-write", body)


def test_a_disabled_node_writes_nothing(expect: Expect) -> None:
    expect("read-before-write", main(f"- {SEE}", "  disabled: true", "- pick: «$it»"))


def test_a_forced_success_may_not_have_written(expect: Expect) -> None:
    expect("read-before-write", main(f"- {SEE}", "  force: success", "- pick: «$it»"))


def test_a_retried_node_has_written(fine: Fine) -> None:
    fine(main(f"- {SEE}", "  retry: 3", "  timeout: 20 s", "- pick: $it"))


def test_an_inverted_node_that_succeeds_has_not_written(expect: Expect) -> None:
    expect("read-before-write", main(f"- {SEE}", "  invert:", "- pick: «$it»"))


def test_siblings_in_parallel_do_not_write_for_each_other(expect: Expect) -> None:
    body = main("- parallel:", f"    - {SEE}", "    - pick: «$it»")
    expect("read-before-write", body)


def test_parallel_success_of_all_has_written(fine: Fine) -> None:
    fine(main("- parallel:", f"    - {SEE}", "    - wait: 1 s", "- pick: $it"))


def test_recover_writes_what_try_writes(fine: Fine) -> None:
    fine(
        main(
            "- recover:",
            "    attempts: 2",
            f"    try: {{{SEE}}}",
            "    catch: {OBJECT_NOT_FOUND: again}",
            "- pick: $it",
        )
    )


def test_a_handler_reads_the_failure(fine: Fine) -> None:
    fine(
        main(
            "- recover:",
            "    attempts: 2",
            "    try: relocalize",
            '    catch: {any: {say: "lost: ${failure.message}"}}',
        )
    )


def test_the_failure_is_known_to_handlers_alone(expect: Expect) -> None:
    expect("read-before-write", main("- say: «$failure.code»"))


def test_unset_takes_the_key_away(expect: Expect) -> None:
    expect("read-before-write", main("- say: $a", "- unset: $a", "- say: «$a»", values="{a: x}"))


def test_what_follows_fail_is_never_reached(expect: Expect) -> None:
    expect("unreachable", main("- fail: {code: NO_WAY}", "- «say»: $anything"))


def test_wrong_type_along_a_wire(expect: Expect) -> None:
    body = main(f"- {SEE}", "- say: «$it»")
    expect("wrong-type", body, message="$it is detected_object; 'text' of say takes text")


def test_wrong_type_of_a_part(expect: Expect) -> None:
    body = main(f"- {SEE}", "- navigate: {side: «$it.pose»}")
    expect("wrong-type", body, message="$it.pose is pose; 'side' of navigate takes int")


def test_a_part_of_the_right_type(fine: Fine) -> None:
    fine(main(f"- {SEE}", "- navigate: {within_reach_of: $it.pose}"))


def test_unknown_part(expect: Expect) -> None:
    body = main(f"- {SEE}", "- navigate: {within_reach_of: «$it.pos»}")
    expect("unknown-part", body, hint="did you mean pose?")


def test_a_whole_number_flows_into_a_number_but_not_back(fine: Fine, expect: Expect) -> None:
    fine(main("- count: {number: $n}", "- navigate: {tolerance: $n}"))
    tree = main("- Sub: {x: 1.5}") + "  Sub:\n    inputs: {x: number}\n    navigate: {side: «$x»}\n"
    expect("wrong-type", tree)


def test_a_value_that_does_not_fit(expect: Expect) -> None:
    body = main("- navigate: {tolerance: $near}", values="{near: «3 s»}")
    expect("wrong-value", body, message="expected a length", hint="line 7")


def test_a_value_with_its_unit_fits(fine: Fine) -> None:
    fine(main("- navigate: {tolerance: $near}", values="{near: 3 cm}"))


def test_a_name_behind_a_value_is_checked_at_the_value(expect: Expect) -> None:
    body = main("- navigate: $to", values="{to: «tabel_a»}")
    expect("unknown-place", body, hint="did you mean table_a?")


def test_a_name_behind_two_subtrees_is_checked(expect: Expect) -> None:
    tree = (
        main("- Go: {to: $to}", values="{to: «tabel_a»}")
        + "  Go:\n    inputs: {to: text}\n    Drive: {there: $to}\n"
        + "  Drive:\n    inputs: {there: text}\n    navigate: $there\n"
    )
    expect("unknown-place", tree, hint="did you mean table_a?")


def test_a_name_written_to_a_subtree_is_checked(expect: Expect) -> None:
    tree = main("- Go: «tabel_a»") + "  Go:\n    inputs: {to: text}\n    navigate: $to\n"
    expect("unknown-place", tree)


@pytest.mark.parametrize(
    "tree",
    [
        main("- Go: {far: $far}", values="{far: «5 kg»}"),
        main("- Go: {far: «5 kg»}"),
        main("- Go: {far: «5 min»}"),
    ],
)
def test_a_unit_behind_two_subtrees_is_checked(expect: Expect, tree: str) -> None:
    tree += "  Go:\n    inputs: {far: number}\n    Drive: {within: $far}\n"
    tree += "  Drive:\n    inputs: {within: number}\n    navigate: {goal: {x: 1, y: 2}, "
    tree += "tolerance: $within}\n"
    expect("wrong-value", tree, message="expected a length, in: mm, cm, m")


def test_a_right_unit_behind_a_subtree_is_fine(fine: Fine) -> None:
    tree = main("- Go: {far: 50 mm}")
    tree += "  Go:\n    inputs: {far: number}\n    navigate: {in_front_of: table_a, "
    fine(tree + "tolerance: $far}\n")


def test_types_across_a_subtree(expect: Expect) -> None:
    tree = main(f"- {SEE}", "- Sub: {x: «$it»}") + "  Sub:\n    inputs: {x: int}\n    say: '${x}'\n"
    expect("wrong-type", tree, message="'x' of Sub takes int")


def test_an_output_that_is_not_always_written(expect: Expect) -> None:
    sub = f"  Sub:\n    outputs: {{it: «detected_object»}}\n    fallback: [{{{SEE}}}, relocalize]\n"
    expect("unwritten-output", main("- Sub: {it: $it}", "- pick: $it") + sub)


def test_an_output_of_another_type(expect: Expect) -> None:
    sub = f"  Sub:\n    outputs: {{it: «pose»}}\n    sequence: [{{{SEE}}}]\n"
    expect("wrong-type", main("- Sub") + sub, message="but detected_object comes")


def test_keys_of_a_subtree_are_its_own(expect: Expect) -> None:
    tree = main(f"- {SEE}", "- pick: $it", "- Sub") + "  Sub:\n    pick: «$it»\n"
    expect("read-before-write", tree)


def test_the_roots_board(fine: Fine, expect: Expect) -> None:
    sub = "  Sub:\n    - say: $@name\n    - say: {text: a, pace: $@localization.quality}\n"
    fine(main("- Sub", values="{name: a}") + sub)
    fine(main("- script: $made := 1", "- Sub") + "  Sub: [{navigate: {side: $@made}}]\n")
    expect("unknown-key", main("- say: «$@nam»", values="{name: a}"), hint="did you mean name?")


def test_an_output_that_nobody_reads_is_a_warning(check: Callable[[str], list[Problem]]) -> None:
    found = check("momantu_bt: 1\nworld: rooms\n" + main(f"- {SEE}"))
    assert [(p.code, p.severity) for p in found] == [("unread-output", Severity.WARNING)]


@pytest.mark.parametrize(
    ("script", "code", "hint"),
    [
        ("$n > 1 and «$mm» > 2", "read-before-write", "keys that have a value here: n"),
        ("$n > 2 «m»", "script", "did you mean $m"),
        ('"$n > 2 «m»"', "script", "did you mean $m"),
        ("«$n > 2 ? 3»", "script", ""),
        ("$n == 1 or $n == 2 «and» $n == 3", "script", "write ($a and $b) or $c"),
        ("«not» $n == 3", "script", "write not ($a == $b)"),
    ],
)
def test_scripts_are_checked_where_they_stand(
    expect: Expect, script: str, code: str, hint: str
) -> None:
    expect(code, main(f"- condition: {script}", values="{n: 1}"), hint=hint)


def test_a_script_writes_keys(fine: Fine, expect: Expect) -> None:
    fine(main("- script: $k := $n + 1", "- condition: $k > 1", values="{n: 1}"))
    expect("read-before-write", main("- script: $k := «$m» + 1", "- condition: $k > 1"))


def test_conditions_read_keys(expect: Expect) -> None:
    expect("read-before-write", main("- relocalize:", "  skip_if: not «$known»"))


def test_for_each_gives_its_item(fine: Fine, expect: Expect) -> None:
    count = "- count: {poses: $stops}"
    fine(main(count, "- for_each: {in: $stops, as: $stop, child: {navigate: {goal: $stop}}}"))
    body = main(count, "- for_each: {in: $stops, as: $stop, child: {navigate: {side: «$stop»}}}")
    expect("wrong-type", body, message="$stop is pose2d")


def test_for_each_until_success_leaves_the_item(fine: Fine, expect: Expect) -> None:
    count = "- count: {poses: $stops}"
    loop = "- for_each: {in: $stops, as: $stop, until: success, child: {navigate: {goal: $stop}}}"
    after = "- navigate: {goal: $stop}"
    fine(main(count, loop, after))
    body = main(count, loop.replace(", until: success", ""), after.replace("$stop", "«$stop»"))
    expect("read-before-write", body)
    wrong = main(count, loop.replace("success", "«done»"))
    expect("wrong-value", wrong, message="'done' is not one of failure, success")


def test_a_written_list_is_checked_item_by_item(fine: Fine, expect: Expect) -> None:
    loop = "- for_each: {in: $stops, as: $stop, child: {navigate: {in_front_of: $stop}}}"
    expect("unknown-place", main(loop, values="{stops: «[table_a, tabel_b]»}"), message="'tabel_b'")
    fine(main(loop, values="{stops: [table_a, table_b]}"))
    direct = loop.replace("$stops", "«[table_a, tabel_b]»")
    expect("unknown-place", main(direct), message="'tabel_b'")


def test_an_item_that_does_not_fit(expect: Expect) -> None:
    loop = "- for_each: {in: $sides, as: $side, child: {navigate: {side: $side}}}"
    expect("wrong-value", main(loop, values="{sides: «[1, left]»}"), message="'left'")


def test_a_value_of_the_root_is_checked_where_a_wire_takes_it(fine: Fine, expect: Expect) -> None:
    sub = "  Main: [Sub]\n  Sub: [{wait: $@pause}]\n"
    expect("wrong-value", f"values: {{pause: «3 m»}}\ntrees:\n{sub}", message="'3 m'")
    fine(f"values: {{pause: 3 s}}\ntrees:\n{sub}")


def test_a_value_of_the_root_that_is_overwritten_may_be_anything(fine: Fine) -> None:
    sub = "  Main: [{script: $pause := 3}, Sub]\n  Sub: [{wait: $@pause}]\n"
    fine(f"values: {{pause: later}}\ntrees:\n{sub}")


def test_a_part_that_the_robot_does_not_have(expect: Expect) -> None:
    expect("unknown-part", main("- condition: «$@robot».stmp > 3"), hint="did you mean stamp?")


def test_only_colon_equals_makes_a_key_of_the_root(fine: Fine, expect: Expect) -> None:
    expect("unknown-key", main("- script: «$@cuont» = 3", values="{count: 0}"), hint="count?")
    fine(main("- script: $@count := 3"))


@pytest.mark.parametrize(
    ("script", "values", "message"),
    [
        ("$name > 3", "{name: a}", "compares a text with a number"),
        ("$n + $name > 3", "{n: 1, name: a}", "joins a number and a text"),
        ("$name - $name == 'b'", "{name: a}", "does not work on texts"),
        ("-$name > 3", "{name: a}", "needs a number, not a text"),
        ("$limit > 3", "{limit: 3 sc}", "compares a text with a number"),
        ("$list > 3", "{list: [1]}", None),
        ("$n == 3 ? $n > 2 : $n > 1", "{n: 1}", None),
        ("$limit > 3", "{limit: 3 s}", None),
        ("$name == 'b'", "{name: a}", None),
    ],
)
def test_types_in_scripts(
    check: Callable[[str], list[Problem]], script: str, values: str, message: str | None
) -> None:
    header = "momantu_bt: 1\nworld: rooms\nmain: Main\n"
    found = check(header + main(f'- condition: "{script}"', values=values))
    if message is None:
        assert found == []
    else:
        assert [problem.code for problem in found] == ["wrong-type"]
        assert message in found[0].message


def test_an_output_that_is_of_the_wrong_type_on_one_way(fine: Fine, expect: Expect) -> None:
    sub = """trees:
  Main: [{Sub: {good: $good}}, {condition: $good}]
  Sub:
    outputs: {good: «bool»}
    handle:
      try: {set: {key: $good, value: yes}}
      catch: {any: {set: {key: $good, value: false}}}
"""
    expect("wrong-type", sub, message="but text comes", hint="line 9")
    fine(sub.replace("yes", "true").replace("«", "").replace("»", ""))


def test_a_wire_to_what_is_of_the_wrong_type_on_one_way(expect: Expect) -> None:
    body = main(
        "- if: $n > 1",
        "  then: {set: {key: $side, value: left}}",
        "  else: {set: {key: $side, value: 2}}",
        "- navigate: {in_front_of: table_a, side: «$side»}",
        values="{n: 1}",
    )
    expect("wrong-type", body, message="$side is text", hint="line 8")


class Gauge(Service):
    """Publishes a charge."""

    publishes = {"charge": float}


@pytest.mark.parametrize(
    ("body", "code", "said"),
    [
        ("- condition: $@gauge.chrge < 0.2", "unknown-part", "has no part 'chrge'"),
        ("- navigate: {in_front_of: $@gauge.charge}", "wrong-type", "takes text"),
        ("- condition: $@broken.charge < 0.2", "broken-plugin", "cannot be loaded"),
        ("- condition: $@gaug.charge < 0.2", "unknown-key", "no key 'gaug'"),
    ],
)
def test_what_a_service_publishes_is_known(tmp_path, body: str, code: str, said: str) -> None:
    class Broken(dict):
        def __getitem__(self, name):
            if name == "broken":
                raise PluginError("the service 'broken' (a:B of p) cannot be loaded: NameError: x")
            return super().__getitem__(name)

    services = Broken(gauge=Gauge, broken=None)
    file = tmp_path / "tree.yaml"
    file.write_text("momantu_bt: 1\n" + main(body))
    with pytest.raises(TreeError) as error:
        load(str(file), replace(Registry.installed(), services=services))
    (problem,) = error.value.problems
    assert (problem.code, problem.place.line) == (code, 4)
    assert said in problem.message
