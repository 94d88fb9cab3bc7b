"""What leads from one tree to another."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.drawing import matching
from momantu_bt.drawing.difference import Marked, difference
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.load import load, read_file
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry

Read = Callable[[str], Document]
Texts = st.SearchStrategy[str]

BASE = """
momantu_bt: 1
world: four_rooms
main: Main
values: {n: 3}
trees:
  Main:
    - a: {x: 1}
      retry: 3
    - sequence: [b, {c: {to: $n}}, d]
    - recover: {attempts: 2, try: e, catch: {A | B: again, any: f}}
    - Sub: {at: $n}
  Sub:
    inputs: {at: int}
    sequence: [{g: {to: $at}}, h]
"""


def changes(document: Read, old: str, new: str) -> list[str]:
    """The lines with a mark, from the base to the base with one text replaced."""
    assert BASE.count(old) == 1, old
    found = difference(document(BASE), document(BASE.replace(old, new)))
    return [f"{line.mark} {line.text}" for line in found if line.mark != " "]


@pytest.mark.parametrize(
    ("old", "new", "lines"),
    [
        ("{x: 1}", "{x: 2}", ["~ a x 2  (3 tries)  [x 1 -> 2]"]),
        ("{x: 1}", "{x: '1'}", ['~ a x 1  (3 tries)  [x 1 -> "1"]']),
        ("{x: 1}", "{y: 1}", ["~ a y 1  (3 tries)  [- x 1; + y 1]"]),
        ("retry: 3", "retry: 4", ["~ a x 1  (4 tries)  [retry 3 -> 4]"]),
        ("retry: 3", "timeout: 2 s", ["~ a x 1  (at most 2 s)  [- retry 3; + timeout 2 s]"]),
        ("retry: 3", "name: way", ["~ way: a x 1  [was a; - retry 3]"]),
        ("retry: 3", "disabled: true", ["~ a x 1  (disabled)  [- retry 3; + disabled]"]),
        (", d]", "]", ["- d"]),
        ("[b,", "[b, i,", ["+ i"]),
        ("[b, {c: {to: $n}}, d]", "[{c: {to: $n}}, d, b]", ["~ b  [moved, was in line 10]"]),
        ("e, catch", "[e, i], catch", ["+ sequence", "~ e  [moved, was in line 11]", "+ i"]),
        ("A | B: again", "A: again", [
            "~ recover with 2 tries; on A: try again  [- on A or B: try again; + on A: try again]"
        ]),
        ("any: f", "C: f", ["~ on C: f  [was on anything else]"]),
        ("world: four_rooms\n", "", ["~ world: four_rooms -> none"]),
        ("{n: 3}", "{n: 3, m: a}", ["+ m = a"]),
        ("{n: 3}", "{n: 4}", ["~ n = 3 -> 4"]),
        ("inputs: {at: int}", "inputs: {at: number}",
         ["~ Sub takes at (number), was Sub takes at (int)"]),
        ("{g: {to: $at}}, h]", "h, {g: {to: $at}}]", ["~ g to $at  [moved, was in line 15]"]),
    ],
)  # fmt: skip
def test_one_change(document: Read, old: str, new: str, lines: list[str]) -> None:
    assert changes(document, old, new) == lines


def test_comments_and_the_way_it_is_written_do_not_count(document: Read) -> None:
    other = BASE.replace(
        "    - a: {x: 1}\n      retry: 3\n",
        "    # it\n    - {retry: {attempts: 3, child: {a: {x: 1}}}}\n",
    )
    assert difference(document(BASE), document(other)) == []


def test_what_is_the_same_below_is_left_out(document: Read) -> None:
    found = difference(document(BASE), document(BASE.replace("x: 1", "x: 2")))
    assert [f"{line.mark} {line.depth} {line.text}" for line in found] == [
        "  0 Main",
        "  1 sequence",
        "~ 2 a x 2  (3 tries)  [x 1 -> 2]",
        "  2 sequence …",
        "  2 recover with 2 tries; on A or B: try again …",
        "  2 Sub at $n",
    ]


def test_a_tree_that_only_one_has(document: Read) -> None:
    other = BASE[: BASE.index("  Sub:")].replace("    - Sub: {at: $n}\n", "")
    found = difference(document(BASE), document(other))
    marked = [f"{line.mark} {line.text}" for line in found if line.mark != " "]
    assert marked == ["- Sub at $n", "- Sub takes at (int)", "- sequence", "- g to $at", "- h"]


@given(data=st.data())
def test_nothing_differs_from_itself(texts: Texts, document: Read, data: st.DataObject) -> None:
    text = data.draw(texts)
    assert difference(document(text), document(text)) == []


@given(data=st.data())
def test_it_is_empty_only_where_the_documents_say_the_same(
    texts: Texts, document: Read, data: st.DataObject
) -> None:
    left, right = data.draw(texts), data.draw(texts)
    first, second = document(left), document(right)
    assert (difference(first, second) == []) is (first == second)


def counted(found: list[Marked]) -> Counter[str]:
    return Counter(line.mark for line in found)


@given(data=st.data())
def test_the_way_back_takes_away_what_the_way_there_adds(
    texts: Texts, document: Read, data: st.DataObject
) -> None:
    left, right = data.draw(texts), data.draw(texts)
    first, second = document(left), document(right)
    there, back = counted(difference(first, second)), counted(difference(second, first))
    assert (there["+"], there["-"], there["~"]) == (back["-"], back["+"], back["~"])


@given(data=st.data())
def test_each_node_is_matched_at_most_once(
    texts: Texts, document: Read, data: st.DataObject
) -> None:
    left, right = data.draw(texts), data.draw(texts)
    roots = [matching.units(document(text)) for text in (left, right)]
    found = matching.match(*roots)
    for side in (0, 1):
        its = [id(pair[side]) for pair in (*found.placed, *found.moved)]
        assert len(its) == len(set(its))


def test_long_lists_are_compared_too(document: Read, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(matching, "MOST_COMPARED", 4)
    head = "momantu_bt: 1\ntrees:\n  A:\n"
    before = [f"    - a: {{x: {n}}}\n" for n in range(30)]
    after = [before[5], *before[:5], *before[7:], "    - b\n"]
    found = difference(document(head + "".join(before)), document(head + "".join(after)))
    assert counted(found) == {" ": 30, "+": 1, "-": 1, "~": 1}


@pytest.mark.parametrize("name", sorted(bundled()))
def test_a_bundled_tree_is_itself(name: str, registry: Registry) -> None:
    assert difference(load(name, registry).document, load(name, registry).document) == []


XML = """<root BTCPP_format="4" main_tree_to_execute="Main" xmlns:momantu="urn:momantu-bt:1">
  <BehaviorTree ID="Main">
    <Sequence>
      <RetryUntilSuccessful num_attempts="3"><a x="1"/></RetryUntilSuccessful>
      <SubTree ID="Sub" at="{n}" _skipIf="n &gt; 2"/>
      <momantu:Recover attempts="2"><b/><momantu:Catch codes="A | B"/></momantu:Recover>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Sub"><g to="{at}"/></BehaviorTree>
  <TreeNodesModel>
    <SubTree ID="Main"/><SubTree ID="Sub"><input_port name="at" type="int"/></SubTree>
  </TreeNodesModel>
</root>
"""
YAML = """momantu_bt: 1
main: Main
trees:
  Main:
    - {a: {x: 1}, retry: 3}
    - {Sub: {at: $n}, skip_if: $n > 2}
    - recover: {attempts: 2, try: b, catch: {A | B: again}}
  Sub: {inputs: {at: int}, g: {to: $at}}
"""


def test_a_tree_says_the_same_in_either_spelling(document: Read, tmp_path: Path) -> None:
    path = tmp_path / "t.xml"
    path.write_text(XML, encoding="utf-8")
    other, problems = read_file(path)
    assert problems.sorted() == []
    assert difference(document(YAML), other) == []
    changed = difference(document(YAML.replace("retry: 3", "retry: 4")), other)
    assert [line.text for line in changed if line.mark != " "] == [
        "a x 1  (3 tries)  [retry 4 -> 3]"
    ]
