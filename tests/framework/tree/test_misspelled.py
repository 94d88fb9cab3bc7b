"""Misspelled words and names: one error each, in their line, and the rest is read as meant."""

from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.cli import main
from momantu_bt.formats.problems import Problem

Check = Callable[[str], list[Problem]]

TEXT = """\
momantu_bt: 1
world: rooms
main: Main
values:
  from: table_a
trees:
  Main:
    - recover:
        attempts: 2
        try:
          - Find: {place: $from, side: 1, seen: $seen}
          - pick: {object: $seen}
        catch:
          any:
            round_robin:
              - Go: {place: $from}
              - Go: {place: table_b}
    - Find: {place: table_b, side: 2, seen: $other}
    - Go: {place: $from}
    - pick: {object: $other}
    - retry: {attempts: 3, child: {Go: {place: $from}}}
    - if: $other.score > 0.5
      then: {Go: {place: $from}}
      else: relocalize
    - parallel_all: {max_failures: 1, children: [{wait: 1 s}, {say: "at ${from}"}]}
  Find:
    inputs: {place: text, side: {type: int, default: 0}}
    outputs: {seen: detected_object}
    sequence:
      - navigate: {in_front_of: $place, side: $side}
      - detect_object: {object: {category: can}, on: $place, found: $seen}
  Go:
    inputs: {place: text}
    sequence:
      - navigate: {in_front_of: $place}
      - say: "at ${place}"
"""


def wrong(check: Check, text: str) -> list[Problem]:
    return [p for p in check(text) if p.severity.label == "error"]


def line_of(part: str) -> int:
    return TEXT[: TEXT.index(part)].count("\n") + 1


def test_the_text_is_right(check: Check) -> None:
    assert check(TEXT) == []


@pytest.mark.parametrize(
    ("right", "slip", "code", "hint"),
    [
        # words with nodes below them
        ("- recover:", "- recver:", "unknown-node", "recover"),
        ("  try:", "  tri:", "unknown-key", "try"),
        ("  try:", "  run:", "unknown-key", "try"),
        ("  catch:", "  cach:", "unknown-key", "catch"),
        ("  catch:", "  Catch:", "unknown-key", "catch"),
        ("  catch:", "  on_failure:", "unknown-key", "catch"),
        ("attempts: 2", "attemps: 2", "unknown-key", "attempts"),
        ("round_robin:", "round_robn:", "unknown-node", "round_robin"),
        ("- retry:", "- retyr:", "unknown-node", "retry"),
        ("child:", "chld:", "unknown-key", "child"),
        ("children:", "nodes:", "unknown-key", "children"),
        ("max_failures:", "max_failure:", "unknown-key", "max_failures"),
        ("- if:", "- fi:", "unknown-node", "if"),
        ("then:", "thne:", "unknown-key", "then"),
        ("else:", "els:", "unknown-key", "else"),
        ("- parallel_all:", "- paralell_all:", "unknown-node", "parallel_all"),
        # the declared inputs and outputs of a tree
        ("inputs: {place: text}", "inptus: {place: text}", "unknown-key", "inputs"),
        ("inputs: {place: text}", "Inputs: {place: text}", "unknown-key", "inputs"),
        ("outputs: {seen", "output: {seen", "unknown-key", "outputs"),
        ("inputs: {place: text, s", "inputs: {plaze: text, s", "unknown-port", "place"),
        ("inputs: {place: text}", "inputs: {plce: text}", "unknown-port", "place"),
        ("side: {type", "sid: {type", "unknown-port", "side"),
        ("outputs: {seen", "outputs: {sen", "unknown-port", "seen"),
        # names where they are used
        ("- Find: {place: $from", "- Find: {plce: $from", "unknown-port", "place"),
        ("pick: {object: $seen}", "pick: {what: $seen}", "unknown-port", "object"),
        ("seen: $seen", "sen: $seen", "unknown-port", "seen"),
        ("found: $seen", "fond: $seen", "unknown-port", "found"),
        ("seen: $other", "seen: other", "not-a-key", "$other"),
        ("seen: $other", "seen: {other}", "braces", "$other"),
        ("seen: $other", 'seen: "{other"', "not-a-key", "$other"),
        ("\n  Go:", "\n  Goo:", "unknown-node", "Go"),
        ("values:", "values:\nvalues:", "duplicate-key", ""),
    ],
)
def test_one_slip_is_one_error(check: Check, right: str, slip: str, code: str, hint: str) -> None:
    assert TEXT.count(right) >= 1
    problems = wrong(check, TEXT.replace(right, slip, 1))
    line = line_of(right) + slip.count("\n") if right[0] != "\n" else line_of(right) + 1
    assert [(p.code, p.place.line) for p in problems] == [(code, line)]
    assert f"did you mean {hint}?" in problems[0].hint or not hint


def test_what_is_not_declared_is_told_once_at_the_tree(check: Check) -> None:
    left_out = TEXT.replace("inputs: {place: text, side: {type: int, default: 0}}\n    ", "")
    (problem,) = wrong(check, left_out)
    assert (problem.code, problem.place.line) == ("unknown-port", line_of("outputs: {seen") - 1)
    assert "does not declare the inputs place and side" in problem.message
    assert problem.hint == "under `inputs:` add `place: TYPE`, `side: TYPE`"
    (problem,) = wrong(check, TEXT.replace("    inputs: {place: text}\n", ""))
    assert (problem.code, problem.place.line) == ("unknown-port", line_of("  Go:\n"))
    assert problem.hint == "write `inputs: {place: TYPE}`"


def test_a_key_without_a_value_is_told_where_it_is_first_read(check: Check) -> None:
    problems = wrong(check, TEXT.replace("from: table_a", "form: table_a"))
    lines = [(p.code, p.place.line) for p in problems]
    assert lines == [("read-before-write", line_of("- Find: {place: $from"))]


def test_all_inputs_that_a_node_lacks_are_one_error(check: Check) -> None:
    (problem,) = wrong(check, TEXT.replace("object: {category: can}, on: $place, ", ""))
    assert problem.message == "detect_object needs the inputs 'object' and 'on'"
    assert "object: " in problem.hint
    assert "on: text" in problem.hint


def test_other_mistakes_are_told_beside_a_misspelled_word(check: Check) -> None:
    text = TEXT.replace("- recover:", "- recver:").replace("pick: {object: $seen}", "pick: $se")
    assert {p.code for p in wrong(check, text)} == {"unknown-node", "read-before-write"}


def test_names_that_are_near_to_words_keep_their_meaning(check: Check) -> None:
    text = TEXT.replace("  Go:", "  Input:").replace("Go:", "Input:")
    assert check(text) == []


XML = """\
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence>
      <SubTree ID="Go" place="table_a"/>
      <SubTree ID="Go" place="table_b"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Go">
    <navigate in_front_of="{place}"/>
  </BehaviorTree>
  <TreeNodesModel>
    <SubTree ID="Go">
      <input_port name="place" type="std::string"/>
    </SubTree>
  </TreeNodesModel>
</root>
"""


def test_a_declared_input_in_xml(check: Check) -> None:
    assert wrong(check, XML) == []
    (problem,) = wrong(check, XML.replace('name="place"', 'name="plce"'))
    assert (problem.code, problem.place.line) == ("unknown-port", 13)
    assert problem.hint == "did you mean place?"


@pytest.mark.parametrize("name", ["ReactiveParallel", "reactive_parallel", "Sequenz"])
def test_a_node_of_others_with_a_near_name_comes_back_from_yaml(tmp_path: Path, name: str) -> None:
    """The writer spells `node: NAME` where the reader would take the name for a slip."""
    text = (
        f'<root BTCPP_format="4"><BehaviorTree ID="Main"><{name} limit="3"><AlwaysSuccess/>'
        f"<AlwaysFailure/></{name}></BehaviorTree></root>"
    )
    there, back = tmp_path / "tree.yaml", tmp_path / "back.xml"
    (tmp_path / "tree.xml").write_text(text)
    assert main(["convert", str(tmp_path / "tree.xml"), "-o", str(there)]) == 0
    assert main(["convert", str(there), "-o", str(back)]) == 0
    assert f'<{name} limit="3">' in back.read_text()
    assert f"node: {name}" in there.read_text()
