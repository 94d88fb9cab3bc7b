"""Files that are broken or hostile are refused at once, with their place."""

from pathlib import Path

import pytest
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.read import document
from momantu_worlds.sdf.read.document import parse_document, read_document
from momantu_worlds.sdf.read.uris import version_of

from momantu_bt.formats.places import Place

FILE = Path("room.sdf")


def refusal(data: bytes) -> SdfError:
    with pytest.raises(SdfError) as caught:
        parse_document(data, FILE)
    return caught.value


def test_elements_know_their_places():
    root = parse_document(b"<sdf>\n  <a x='1'> hello <b/></a>\n</sdf>", FILE)
    (a,) = root.children
    assert (a.place, a.text, a.attributes) == (Place(str(FILE), 2, 3), "hello", {"x": "1"})
    assert a.children[0].place == Place(str(FILE), 2, 19)


def bomb(levels: int = 20) -> bytes:
    entities = "".join(
        f"<!ENTITY e{n} '{f'&e{n - 1};' * 10 if n else 'ha'}'>" for n in range(levels)
    )
    return f"<!DOCTYPE sdf [{entities}]>\n<sdf>&e{levels - 1};</sdf>".encode()


@pytest.mark.parametrize(
    ("data", "line", "words"),
    [
        (b"", 1, "not XML"),
        (b"momantu_world: 1\n", 1, "not XML"),
        (b"<sdf>\n<world>\n</sdf>", 3, "mismatched tag"),
        (b"<sdf>\xff\xfe\x00</sdf>", 1, "not XML"),
        (b"<?xml version='1.0' encoding='klingon'?><sdf/>", 1, "not XML"),
        (bomb(), 1, "no entities of its own"),
        (b"<!DOCTYPE s [<!ENTITY x SYSTEM 'file:///etc/passwd'>]><sdf>&x;</sdf>", 1, "no entities"),
        (b"<a>" * 101, 1, "100 elements within each other"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_what_is_no_sdf_is_refused_with_its_line(data, line, words):
    error = refusal(data)
    assert words in str(error)
    assert error.place.line == line


def test_too_many_elements_are_refused(monkeypatch):
    monkeypatch.setattr(document, "MOST_ELEMENTS", 50)
    assert "more than 50 elements" in str(refusal(b"<sdf>" + b"<a/>" * 60 + b"</sdf>"))


def test_a_huge_file_is_refused_unread(tmp_path):
    file = tmp_path / "huge.sdf"
    with file.open("wb") as stream:
        stream.truncate(100_000_000)
    with pytest.raises(SdfError, match="100000000 bytes"):
        read_document(file)


def test_what_is_no_file_is_refused(tmp_path):
    with pytest.raises(SdfError, match="it is a folder"):
        read_document(tmp_path)
    with pytest.raises(SdfError, match="there is no such file"):
        read_document(tmp_path / "none.sdf")


def test_the_message_shows_the_line(tmp_path):
    file = tmp_path / "room.sdf"
    file.write_text("<sdf>\n  <world></word>\n</sdf>")
    with pytest.raises(SdfError) as caught:
        read_document(file)
    first, shown, caret = str(caught.value).split("\n")
    assert first.startswith(f"{file}:2:")
    assert shown == "  2 |   <world></word>"
    assert caret.index("^") - len("  2 | ") == caught.value.place.column - 1


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<robot name='x'/>", "begins with <robot>"),
        ("<sdf/>", "SDF version ''"),
        ("<sdf version='1.1'/>", "expected 1.2 to 1.11"),
        ("<sdf version='1.12'/>", "expected 1.2 to 1.11"),
        ("<sdf version='2.0'/>", "SDF version '2.0'"),
        ("<sdf version='one'/>", "SDF version 'one'"),
    ],
)
def test_other_versions_are_refused(text, words):
    with pytest.raises(SdfError, match=words):
        version_of(parse_document(text.encode(), FILE))


def test_what_gazebos_reader_bears_is_read_and_keeps_its_places():
    data = b"\n \n<?xml version='1.0'?>\n<!-- a -- b\n -->\n<sdf>\n"
    data += b"<a x='1 & 2'>R&D &amp; \xff</a><b/></sdf>"
    root = parse_document(data, FILE)
    assert root.place.line == 6
    a, b = root.children
    assert (a.place.line, b.place.line) == (7, 7)
    assert a.attributes == {"x": "1 & 2"}
    assert a.text == "R&D & \N{REPLACEMENT CHARACTER}"


@pytest.mark.parametrize(
    "version", ["1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "1.8", "1.9", "1.10", "1.11"]
)
def test_versions_that_are_read(version):
    root = parse_document(f"<sdf version='{version}'/>".encode(), FILE)
    assert version_of(root) == tuple(int(part) for part in version.split("."))
    older = parse_document(f"<gazebo version='{version}'/>".encode(), FILE)
    assert version_of(older) == version_of(root)
