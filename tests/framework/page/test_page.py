"""The page as a file: safe whatever a record holds, and the record's data in it."""

import base64
import hashlib
import json
import re
from io import StringIO

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from momantu_bt.formats.files import OutputError
from momantu_bt.page import write_page
from momantu_bt.page.data import page_data
from momantu_bt.page.page import SCRIPTS, as_json, page_text

EVIL = "</script><script>alert(1)</script><!--<img src=x onerror=alert(1)>&amp;'\"\u2028\ud800"
EVIL += " @script@"


def parsed(text):
    """The page by a strict parser; it complains of markup that a text has become."""
    parser = etree.HTMLParser(recover=False, huge_tree=True)
    return etree.parse(StringIO(text), parser).getroot()


def data_in(root):
    return json.loads(root.find(".//script[@id='record']").text)


def test_the_page_is_well_formed_and_holds_the_records_data(recording, tmp_path):
    write_page(recording(), tmp_path / "run.html")
    root = parsed((tmp_path / "run.html").read_text(encoding="utf-8"))
    assert root.findtext(".//title") == "bring"
    assert data_in(root) == json.loads(json.dumps(page_data(recording())))


def test_nothing_is_loaded_from_anywhere(recording):
    root = parsed(page_text(recording()))
    names = {element.tag for element in root.iter() if isinstance(element.tag, str)}
    assert names.isdisjoint({"link", "img", "iframe", "object", "embed", "base"})
    assert not root.xpath("//@src | //@href | //@style")
    assert not re.search(r"url\(|@import", root.findtext(".//style"))
    assert not re.search(
        r"fetch\(|XMLHttpRequest|import\(|innerHTML", root.xpath("string(//script[2])")
    )


def test_the_policy_allows_exactly_this_style_and_script(recording):
    root = parsed(page_text(recording()))
    policy = root.xpath("string(//meta[@http-equiv]/@content)")
    assert policy.startswith("default-src 'none'; img-src data:;")
    for text, rule in (
        (root.findtext(".//style"), "style-src"),
        (root.xpath("string(//script[2])"), "script-src"),
    ):
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"{rule} 'sha256-{digest}'" in policy


def test_no_name_becomes_markup(recording):
    nodes = [(EVIL, EVIL, 0, None, EVIL, 1)]
    about = {"tree": EVIL, "options": {EVIL: EVIL}}
    evil = recording(nodes=nodes, story={}, about=about, files={EVIL: EVIL})
    text = page_text(evil)
    root = parsed(text)
    assert text.count("<script") == 2
    assert text.count("</script>") == 2
    data = data_in(root)
    assert data["labels"]["texts"] == data["nodes"]["name"] == [EVIL]
    assert data["files"] == [{"name": EVIL, "text": EVIL}]
    assert "<img src=x onerror=alert(1)>" in root.findtext(".//title")


@given(
    st.recursive(st.text() | st.integers(), lambda x: st.dictionaries(st.text(), x), max_leaves=5)
)
def test_json_in_the_page_is_the_same_data_and_has_no_markup(value):
    text = as_json({"value": value})
    assert json.loads(text) == {"value": value}
    assert text.isascii()
    assert not set(text) & set("<>&")


def test_the_same_record_gives_the_same_page(recording):
    assert page_text(recording()) == page_text(recording())


def test_a_page_is_small(recording):
    empty = len(page_text(recording(story={}, ticks=1)))
    assert empty < 80_000
    more = len(page_text(recording(story={}, ticks=2001)))
    assert more - empty < 2000 * 40


def test_every_script_is_in_the_page_once(recording):
    text = page_text(recording())
    for name in SCRIPTS:
        first = next(iter((page_asset(name)).splitlines()))
        assert text.count(first) == 1


def page_asset(name):
    from importlib.resources import files

    return files("momantu_bt.page").joinpath("assets", f"{name}.js").read_text(encoding="utf-8")


def test_a_folder_that_does_not_exist_is_said(recording, tmp_path):
    with pytest.raises(OutputError, match=r"cannot be written"):
        write_page(recording(), tmp_path / "none" / "run.html")


SCHEMES = ("light", "dark")


@pytest.mark.parametrize("scheme", SCHEMES)
def test_texts_can_be_read_on_every_paper(recording, scheme):
    colours = colours_of(parsed(page_text(recording())).findtext(".//style"))[SCHEMES.index(scheme)]
    inks = ("ink", "soft", "running", "success", "failure", "skipped", "fault")
    for paper in ("paper", "sheet", "hover"):
        for ink in inks:
            assert contrast(colours[ink], colours[paper]) >= 4.5, (ink, paper)
    for paper in ("mark", "chosen"):
        assert contrast(colours["ink"], colours[paper]) >= 4.5, paper


def colours_of(style):
    """The colours by name, of a light page and of a dark one."""
    light, dark = (
        dict(re.findall(r"--(\w+): (#[0-9a-f]{6})", block))
        for block in re.findall(r":root \{(.*?)\}", style, re.DOTALL)[:2]
    )
    return light, {**light, **dark}


def contrast(one, other):
    """Contrast ratio by WCAG 2.2."""
    low, high = sorted(map(luminance, (one, other)))
    return (high + 0.05) / (low + 0.05)


def luminance(colour):
    parts = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    r, g, b = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b
