"""What the YAML writer writes reads back as the same document, and looks as a person writes it."""

import random
from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.formats.places import Place
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.formats.yaml.values import plain_value
from momantu_bt.tree.convert import meaning
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.files.scalars import CannotWrite, literal
from momantu_bt.tree.files.syntax import compose
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.files.yaml.scripts import script_spelling
from momantu_bt.tree.files.yaml.writer import write
from momantu_bt.tree.model import Document, Literal, Node
from momantu_bt.tree.script import canonical

BUNDLED = sorted(bundled().values())
NASTY = ("yes", "010", "5", "-1", "1e3", "0x1F", "true", "null", "~", "", " a ", "a: b", "a:", "#")
NASTY += ("a #b", "x\ny", "\t", "{x}", "[a, b]", "$", "$5", "${x}", "'", '"', 'it\'s "so"', "\\n")
NASTY += (
    "é ü 木",
    "\x00\x1b",
    "\ufeff",
    "\u2028",
    "- a",
    "---",
    "...",
    "*a",
    "&a",
    "!a",
    "@a",
    "%a",
)
NASTY += ("a" * 300, "1" * 50, "\U0001f916", "a, b", "? b", "| c", "12:30", "a?b", "`", "é\xa0")


@pytest.mark.parametrize("path", BUNDLED, ids=lambda path: path.stem)
def test_a_bundled_tree_comes_back_the_same(path: Path) -> None:
    document, _ = read(path.read_text(encoding="utf-8"), str(path))
    written = write(document)
    again, problems = read(written, str(path))
    assert problems.sorted() == []
    assert again == document
    assert write(again) == written


def test_random_documents_come_back_the_same(
    random_document: Callable[[random.Random], Document],
) -> None:
    for seed in range(250):
        document = random_document(random.Random(seed))
        written = write(document)
        again, problems = read(written, "t.yaml")
        assert problems.sorted() == [], f"seed {seed}\n{written}"
        assert meaning(again) == meaning(document), f"seed {seed}\n{written}"
        assert write(again) == written, f"seed {seed}"


@pytest.mark.parametrize("text", NASTY)
def test_a_text_is_in_quotes_where_yaml_demands_it(text: str) -> None:
    for flow, around in ((False, "k: {}"), (True, "{{k: {}}}"), (True, "k: [{}]")):
        shown = literal(text, flow=flow)
        value = plain_value(compose(around.format(shown), "t"))["k"]
        assert value in (text.replace("$", "$$"), [text.replace("$", "$$")])
    if (
        literal(text)[0] in "'\"" and text.isprintable() and text not in ("---", "...")
    ):  # without quotes it is something else, or nothing at all
        assert _plain(text) != text


def _plain(text: str) -> object:
    try:
        return plain_value(compose(f"k: {text}", "t"))["k"]
    except YamlSyntaxError:
        return None


@pytest.mark.parametrize(
    ("script", "spelled"),
    [
        ("a && !b", "$a and not $b"),
        ("(a && b) || @c.d > 1", "($a and $b) or $@c.d > 1"),
        ("!a == 1", "!$a == 1"),
        ("and := or", "$and := $or"),
        ("a && b || c", None),
        (" a", None),
    ],
)
def test_a_script_is_spelled_so_that_it_comes_back(script: str, spelled: str | None) -> None:
    assert script_spelling(script, asked=False) == spelled
    if spelled is not None:
        assert canonical(spelled) == script


def _yaml(body: str) -> str:
    return f"momantu_bt: 1\nmain: Main\n\ntrees:\n  Main:\n{body}"


@pytest.mark.parametrize(
    "body",
    [
        "    - wait: 1.5 s\n    - relocalize\n    - pick: {object: $found}\n      timeout: 90 s\n",
        "    - relocalize:\n      name: turn\n      note: once\n      disabled: true\n"
        "      skip_if: not $at_a\n      retry: 3\n      force: success\n",
        "    - retry:\n        attempts: 2\n        child:\n          wait: 1 s\n"
        "          retry: 3\n",
        "    - if: $n > 2\n      then: {wait: 1 s}\n      else:\n        - succeed\n"
        "        - fail: OH\n",
        "    - if:\n        succeed:\n        name: ask\n      then: succeed\n",
        "    - parallel:\n        success_count: 1\n        children:\n          - succeed\n",
        "    - for_each: {in: $stops, as: $stop, child: {go: {to: $stop}}}\n",
        "    - script: $n := 1\n      skip_if: {btcpp: a && b || c}\n",
        "    - script: {code: {btcpp: a && b || c}}\n",
        "    recover:\n      attempts: 2\n      try:\n        reset_pose: home\n      catch:\n"
        "        A | pick.B: again\n        any:\n          - succeed\n",
        "    inputs: {at: text, n: {type: int, default: 0, doc: how many}}\n"
        "    outputs: {found: pose}\n    sequence:\n      - succeed\n",
        '    - say: "at ${n}: $$5"\n    - say: $$5\n    - say: {text: [a, {b: c}], when: 5}\n',
    ],
)
def test_what_is_well_written_stays_as_it_is(body: str) -> None:
    text = _yaml(body)
    document, problems = read(text, "t.yaml")
    assert problems.sorted() == []
    assert write(document) == text


def test_a_long_list_has_an_item_a_line() -> None:
    items = ", ".join(f"{{category: can, diameter: {n} mm}}" for n in range(5))
    text = f"momantu_bt: 1\nmain: M\nvalues: {{objects: [{items}]}}\ntrees: {{M: succeed}}\n"
    document, _ = read(text, "t.yaml")
    written = write(document)
    assert "  objects:\n    - {category: can, diameter: 0 mm}\n" in written
    assert read(written, "t.yaml")[0] == document


def test_what_yaml_has_no_words_for_is_refused() -> None:
    place = Place("t.yaml", 1, 1)
    for node in (
        Node("Recover", place, children=[Node("AlwaysSuccess", place)]),
        Node("pick", place, ports={"at": Literal(float("inf"))}),
    ):
        text = "momantu_bt: 1\ntrees: {Main: succeed}"
        document, _ = read(text, "t.yaml")
        document.trees["Main"].root = node
        with pytest.raises(CannotWrite):
            write(document)
