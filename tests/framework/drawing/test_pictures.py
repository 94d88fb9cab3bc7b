"""Boxes, and what the three languages make of them: whole, escaped, nothing on top of another."""

import itertools
import re
from collections.abc import Callable
from pathlib import Path

import pydot
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from momantu_bt.drawing.boxes import WIDEST, cut, pictures, width_of
from momantu_bt.drawing.dot import dot, quoted
from momantu_bt.drawing.layout import CELL, PAD, Placed, outlines, wrapped
from momantu_bt.drawing.mermaid import escaped, mermaid
from momantu_bt.drawing.svg import svg
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.load import load
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry

Read = Callable[[str], Document]
Texts = st.SearchStrategy[str]
SVG = "{http://www.w3.org/2000/svg}"
SMALL = """
momantu_bt: 1
trees:
  Main:
    - recover:
        attempts: 3
        try: {detect_object: {object: {category: can}, on: table_a, found: $seen}, retry: 2}
        catch: {OBJECT_NOT_FOUND: again, any: {wait: 2 s}}
    - pick: {object: $seen}
"""
DOT = """\
digraph trees {
  ordering=out; rankdir=TB; compound=true;
  node [fontname="Helvetica" fontsize=11];
  edge [fontname="Helvetica" fontsize=9 arrowsize=0.6];
  subgraph cluster_0 {
    label="Main"; labeljust=l; color=gray70;
    n1 [label="sequence" shape=box style="filled" fillcolor="#dbe7f6"];
    n2 [label="recover\\nwith 3 tries\\non OBJECT_NOT_FOUND: try again" shape=box style="filled" fillcolor="#dbe7f6"];
    n3 [label="detect_object\\nobject {category: can}\\non table_a\\nfound $seen\\n2 tries" shape=box style="filled,rounded" fillcolor="#dcf0dd"];
    n4 [label="wait\\n2 s" shape=box style="filled,rounded" fillcolor="#f1efe6"];
    n5 [label="pick\\nobject $seen" shape=box style="filled,rounded" fillcolor="#dcf0dd"];
    n1 -> n2;
    n2 -> n3;
    n2 -> n4 [label="on anything else"];
    n1 -> n5;
    n3 -> n5 [label="$seen" style=dashed color="#b3541e" fontcolor="#b3541e" constraint=false];
  }
}
"""  # noqa: E501
MERMAID = """\
flowchart TD
  subgraph t0["Main"]
    n1["sequence"]:::control
    n2["recover<br/>with 3 tries<br/>on OBJECT_NOT_FOUND: try again"]:::control
    n3("detect_object<br/>object #123;category: can#125;<br/>on table_a<br/>found #36;seen<br/>2 tries"):::skill
    n4("wait<br/>2 s"):::leaf
    n5("pick<br/>object #36;seen"):::skill
    n1 --> n2
    n2 --> n3
    n2 -->|"on anything else"| n4
    n1 --> n5
    n3 -.->|"#36;seen"| n5
  end
"""  # noqa: E501


def all_nodes(document: Document) -> list[int]:
    return [id(node) for tree in document.trees.values() for node in tree.root.walk()]


@given(data=st.data())
def test_every_node_is_in_one_box(texts: Texts, document: Read, data: st.DataObject) -> None:
    whole = document(data.draw(texts))
    boxes = [box for tree in pictures(whole, Registry()) for box in tree.boxes]
    assert sorted(id(node) for box in boxes for node in box.nodes) == sorted(all_nodes(whole))
    assert [box.number for box in boxes] == list(range(1, len(boxes) + 1))
    roots = [box for box in boxes if box.parent is None]
    assert len(roots) == len(whole.trees)
    assert all(box.depth == boxes[box.parent - 1].depth + 1 for box in boxes if box.parent)


def meet(one: Placed, two: Placed) -> bool:
    """Whether two boxes have a point in common."""
    return not (
        one.right < two.x
        or two.right < one.x
        or one.y + one.height < two.y
        or two.y + two.height < one.y
    )


@given(data=st.data())
def test_nothing_lies_on_top_of_another_and_all_text_fits(
    texts: Texts, document: Read, data: st.DataObject
) -> None:
    drawn = outlines(pictures(document(data.draw(texts)), Registry()))
    placed = [each for outline in drawn for each in outline.boxes]
    assert not any(meet(*two) for two in itertools.combinations(placed, 2))
    for each in placed:
        assert all(width_of(line) * CELL + 2 * PAD <= each.width + 1e-9 for line in each.lines)
        assert len(each.lines) * 16.0 <= each.height
    for one, two in itertools.pairwise(drawn):
        assert one.y + one.height <= two.y
    for outline in drawn:
        assert all(each.right <= outline.width for each in outline.boxes)
        assert all(lane.x <= outline.width for lane in outline.lanes)


@given(data=st.data())
def test_wires_keep_clear_of_boxes_and_of_each_other(
    texts: Texts, document: Read, data: st.DataObject
) -> None:
    for outline in outlines(pictures(document(data.draw(texts)), Registry())):
        where = {each.box.number: each for each in outline.boxes}
        heights = [plug.y for lane in outline.lanes for plug in lane.plugs]
        assert len(set(heights)) == len(heights)
        for lane in outline.lanes:
            assert any(plug.writes for plug in lane.plugs)
            for plug in lane.plugs:
                its = where[plug.number]
                assert its.y <= plug.y <= its.y + its.height
                crossed = [
                    each
                    for each in outline.boxes
                    if each is not its and each.y <= plug.y <= each.y + each.height
                ]
                assert crossed == []
                assert lane.x > max(
                    each.right
                    for each in outline.boxes
                    if each.box.number in {p.number for p in lane.plugs}
                )
        for one, two in itertools.combinations(outline.lanes, 2):
            if one.x == two.x:
                assert max(p.y for p in one.plugs) < min(p.y for p in two.plugs) or max(
                    p.y for p in two.plugs
                ) < min(p.y for p in one.plugs)


@given(data=st.data())
def test_an_svg_is_well_formed_and_has_a_rectangle_for_each_box(
    texts: Texts, document: Read, data: st.DataObject
) -> None:
    trees = pictures(document(data.draw(texts)), Registry())
    root = etree.fromstring(svg(trees))
    count = sum(len(tree.boxes) for tree in trees)
    assert len(root.findall(f".//{SVG}rect[@class]")) == count
    titles = [element.text for element in root.iter(f"{SVG}text")]
    for tree in trees:
        assert tree.title in titles
        assert all(box.title in titles for box in tree.boxes)


@pytest.mark.parametrize("name", sorted(bundled()))
def test_links_of_an_svg_lead_to_trees(name: str, registry: Registry) -> None:
    document = load(name, registry).document
    root = etree.fromstring(svg(pictures(document, registry)))
    ids = {element.get("id") for element in root.iter(f"{SVG}g")}
    links = {str(element.get("href")).removeprefix("#") for element in root.iter(f"{SVG}a")}
    assert links <= ids
    assert {f"tree-{each}" for each in document.trees} <= ids


def small(tmp_path: Path, registry: Registry) -> Document:
    path = tmp_path / "small.yaml"
    path.write_text(SMALL, encoding="utf-8")
    return load(str(path), registry).document


def test_dot_and_mermaid_of_a_small_tree(tmp_path: Path, registry: Registry) -> None:
    trees = pictures(small(tmp_path, registry), registry)
    assert dot(trees) == DOT
    assert mermaid(trees).startswith(MERMAID)


def test_wires_can_be_left_out(tmp_path: Path, registry: Registry) -> None:
    trees = pictures(small(tmp_path, registry), registry)
    assert "dashed" not in dot(trees, wires=False)
    assert "-.->" not in mermaid(trees, wires=False)
    whole, without = (etree.fromstring(svg(trees, wires=on)) for on in (True, False))
    counted = [len(each.findall(f".//{SVG}g[@class='wires']/*")) for each in (whole, without)]
    assert counted[0] > 0
    assert counted[1] == 0


def test_whatever_a_name_says_it_stays_text(evil: str, document: Read) -> None:
    quoted_text = evil.replace("'", "''")
    trees = pictures(
        document(
            f"momantu_bt: 1\ntrees:\n  A: [{{a: {{x: '{quoted_text}'}}, name: '{quoted_text}'}}]\n"
        ),
        Registry(),
    )
    title = f"{evil}: a"
    assert title in [element.text for element in etree.fromstring(svg(trees)).iter(f"{SVG}text")]
    node = next(line for line in dot(trees).splitlines() if "n2 [" in line)
    strings = re.findall(r'"((?:[^"\\]|\\.)*)"', node)
    assert strings[0].startswith(title.replace("\\", "\\\\").replace('"', '\\"'))
    (box,) = (line for line in mermaid(trees).splitlines() if line.startswith("    n2("))
    label = re.fullmatch(r'    n2\("([^"]*)"\):::skill', box)
    assert label is not None
    said = re.sub(r"#(\d+);", lambda found: chr(int(found[1])), label[1].partition("<br/>")[0])
    assert said == title


@given(text=st.text())
def test_escaping_can_be_undone(text: str, evil: str) -> None:
    text += evil
    assert re.sub(r"#(\d+);", lambda found: chr(int(found[1])), escaped(text)) == text
    inside = quoted(text)[1:-1]
    for shown, meant in (("\\n", "\n"), ('\\"', '"'), ("\\\\", "\\")):
        assert shown in inside or meant not in text


@pytest.mark.parametrize("text", ["x" * 500, "日" * 80, "a\tb\x07c", "e\u0301" * 90])
def test_long_lines_are_cut_and_unprintable_ones_cleaned(text: str) -> None:
    line = cut(text)
    assert width_of(line) <= WIDEST
    assert line.isprintable()
    assert all(width_of(each) <= WIDEST for each in wrapped([text, "a", "b"], ", "))


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # pydot's, of its parser
@pytest.mark.parametrize("name", sorted(bundled()))
def test_graphviz_source_follows_its_grammar(name: str, registry: Registry) -> None:
    trees = pictures(load(name, registry).document, registry)
    (graph,) = pydot.graph_from_dot_data(dot(trees)) or []
    clusters = graph.get_subgraphs()
    assert [len(each.get_nodes()) for each in clusters] == [len(tree.boxes) for tree in trees]
