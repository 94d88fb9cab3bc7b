"""XML as elements with places, and what is wrong with a text that is none, in our words."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.formats.places import lines_of
from momantu_bt.formats.problems import Problem
from momantu_bt.formats.text import Beside
from momantu_bt.formats.xml.elements import Element
from momantu_bt.formats.xml.reader import XmlSyntaxError
from momantu_bt.tree.files.syntax import MAX_BYTES, OURS, XML_RULES, parse

MAX_DEPTH, MAX_NODES = XML_RULES.most_depth, XML_RULES.most_nodes


def refused(text: str) -> Problem:
    with pytest.raises(XmlSyntaxError) as caught:
        parse(text, "t.xml")
    return caught.value.problem


def test_places_of_tags_and_attributes() -> None:
    text = '<root\n   a="1"><!-- > --><x  b = \'two\' c="&amp;"/>\n  <y/></root>'
    root = parse(text, "t.xml").root
    x, y = root.children
    assert (root.place.line, root.place.column, root.place.length) == (1, 2, 4)
    assert (root.attributes[0].name_place.line, root.attributes[0].place.column) == (2, 7)
    b, c = x.attributes
    assert [(p.line, p.column, p.length) for p in (b.name_place, b.place)] == [
        (2, 24, 1),
        (2, 29, 3),
    ]
    assert (c.value, c.place.length) == ("&", 5)
    assert (y.place.line, y.place.column) == (3, 4)


@given(st.data())
def test_every_attribute_stands_where_its_place_says(data: st.DataObject) -> None:
    names = st.sampled_from(["a", "bc", "d_e", "_f", "momantu:g"])
    values = st.text("abc {}=>/é'\t", max_size=6)
    lines, depth = ["<root xmlns:momantu='urn:momantu-bt:1'>"], 1
    for _ in range(data.draw(st.integers(0, 8))):
        written = data.draw(st.dictionaries(names, values, max_size=3))
        attributes = "".join(
            f'{" " * (i + 1)}{n}="{v}"' for i, (n, v) in enumerate(written.items())
        )
        closed = data.draw(st.booleans())
        lines.append(f"{' ' * depth}<n{attributes}{'/' if closed else ''}>")
        depth += not closed
    text = "\n".join([*lines, "</n>" * (depth - 1) + "</root>"])
    waiting, shown = [parse(text, "t.xml").root], lines_of(text)
    while waiting:
        element = waiting.pop()
        waiting.extend(element.children)
        places = [(element.place, element.name)]
        places += [(a.place, a.value.replace("\t", " ")) for a in element.attributes if a.value]
        for place, word in places:
            stretch = shown[place.line - 1][place.column - 1 :][: place.length]
            assert stretch.replace("\t", " ") == word


def test_namespaces() -> None:
    root = parse(f'<root xmlns:m="{OURS}"><m:Recover m:note="n"/></root>', "t.xml").root
    child = root.children[0]
    assert (child.name, child.space, child.said) == ("Recover", OURS, "m:Recover")
    assert child.get("note", OURS) is not None
    assert child.get("note") is None


def test_comments_belong_to_what_follows_or_stands_before_them_in_the_line() -> None:
    text = (
        "<!-- one --><root>\n<!-- two\n three --><x/> <!-- four -->\n<y>\n<!-- five -->\n</y>"
        " <!-- six -->\n<!-- seven --></root>\n<!-- eight -->"
    )
    parsed = parse(text, "t.xml")
    root, (x, y) = parsed.root, parsed.root.children
    assert root.comments == ("one",)
    assert x.comments == ("two\n three", "four")
    assert [type(each) for each in x.comments] == [str, Beside]
    assert (y.comments, y.end_comments) == ((), ("five",))
    assert (root.end_comments, parsed.comments) == (("six", "seven"), ("eight",))


def test_text_inside_an_element() -> None:
    root = parse("<root><a> one <!-- - -->&lt;two </a><b>\n <c/>three</b></root>", "t.xml").root
    a, b = root.children
    assert a.text_place is not None
    assert (a.text, a.text_place.column) == (" one <two ", 11)
    assert b.text_place is not None
    assert (b.text_place.line, b.text_place.column) == (2, 6)


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_lines_end_in_any_way(ending: str) -> None:
    root = parse(ending.join(["\ufeff<root>", "<a/>", "</root>"]), "t.xml").root
    assert root.children[0].place.line == 2


@pytest.mark.parametrize(
    ("text", "message", "hint"),
    [
        ("<root><a>«</root»>", "`</root>` stands where `</a>` should be", "line 1 opens <a>"),
        ("<root>«<a»>", "<a> is never closed", "</a>"),
        ("<root a=«1»/>", "stands in quotes", 'name="value"'),
        ('<root a="1" «a»="2"/>', "'a' stands here twice", ""),
        ("<root «b»/>", "'b' has no value", ""),
        ('<root>\n<a «b="»c/>\n<d e="f"/></root>', "is not closed", "&lt;"),
        ('<root «a="»b < c"/>', "not closed, or has a `<`", "&lt;"),
        ('<root a="x &«&» y"/>', "means nothing in XML", "&amp;"),
        ("<root>«&nbsp;»</root>", "`&nbsp;` means nothing", "&amp;"),
        ('<root a="1"«b»="2"/>', "goes on here", "with a space between"),
        ("<root/>«<»root/>", "follows the end", ""),
        ("«h»ello", "holds no XML", "BTCPP_format"),
        ("<root><!-- a «-»- b --></root>", "inside a comment", ""),
        ("<root «x»:y='1'/>", "prefix `x:` is not declared", ""),
        ("<root «momntu»:y='1'/>", "prefix `momntu:`", "did you mean momantu?"),
        ("<root «momantu»:y='1'/>", "prefix `momantu:`", 'write xmlns:momantu="urn:momantu-bt:1"'),
        ("«<!DOCTYPE» root [<!ENTITY a 'b'>]><root>&a;</root>", "no <!DOCTYPE>", "remove it"),
        ("<root>«\x01»</root>", "cannot stand in XML", ""),
    ],
)
def test_a_syntax_error_in_our_words(text: str, message: str, hint: str) -> None:
    start, length = text.index("«"), text.index("»") - text.index("«") - 1
    line = text.count("\n", 0, start) + 1
    found = refused(text.replace("«", "").replace("»", ""))
    assert (found.code, message in found.message, hint in found.hint) == ("syntax", True, True)
    column = start - (text.rfind("\n", 0, start) + 1) + 1
    assert (found.place.line, found.place.column, found.place.length) == (line, column, length)


def test_the_column_counts_letters() -> None:
    assert refused('<root é="ü" a=1/>').place.column == 15


@pytest.mark.parametrize(
    "text",
    [
        "<a>" * (MAX_DEPTH + 1) + "</a>" * (MAX_DEPTH + 1),
        "<a>" * 5000,
        f"<a>{'<b/>' * MAX_NODES}</a>",
        "<a>" + '<b c="1" d="2"/>' * (MAX_NODES // 3 + 1) + "</a>",
        f"<a>{'<!---->' * MAX_NODES}</a>",
        f"<a>{' ' * MAX_BYTES}</a>",
    ],
)
def test_bounds(text: str) -> None:
    assert refused(text).code in ("too-large", "syntax")


def test_depth_up_to_the_bound() -> None:
    element: Element = parse("<a>" * MAX_DEPTH + "</a>" * MAX_DEPTH, "t.xml").root
    for _ in range(MAX_DEPTH - 1):
        element = element.children[0]
    assert element.children == []


WHOLE = """<?xml version="1.0" encoding="UTF-8"?>
<!-- a file -->
<root BTCPP_format="4" xmlns:momantu="urn:momantu-bt:1">
  <BehaviorTree ID="Main"><Sequence><a b="{c}"/><![CDATA[ ]]></Sequence></BehaviorTree>
</root>
"""


@pytest.mark.parametrize("seed", range(300))
def test_a_damaged_file_is_read_or_refused_with_a_place_inside_it(seed: int) -> None:
    chance = random.Random(seed)
    text = WHOLE
    for _ in range(chance.randint(1, 3)):
        at, size = chance.randrange(len(text)), chance.randint(0, 4)
        put = chance.choice(["", "<", ">", '"', "&", "/", "<!--", "é", "]]>", "\n", "\0", "a", "="])
        text = text[:at] + put + text[at + size :]
    found = problem_of(text)
    if found is not None:
        lines, place = lines_of(text), found.place
        assert 1 <= place.line <= len(lines)
        assert 1 <= place.column <= len(lines[place.line - 1]) + 1


def problem_of(text: str) -> Problem | None:
    try:
        parse(text, "t.xml")
    except XmlSyntaxError as error:
        return error.problem
    return None
