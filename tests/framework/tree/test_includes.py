"""Files that are read together: in both spellings, within the project, once each."""

from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.formats.problems import Problem
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.files import includes
from momantu_bt.tree.files.includes import project_folder
from momantu_bt.tree.load import TreeError, TreeNotFound, load, read_file
from momantu_bt.tree.model import Document, Include, Literal
from momantu_bt.tree.registry import Registry

NODE = "<AlwaysSuccess/>"


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Write files into a project's folder; the path of the first comes back."""
    (tmp_path / "pyproject.toml").write_text("")

    def files(**texts: str) -> Path:
        paths = []
        for name, text in texts.items():
            stem, suffix = name.rsplit("_", 1)
            path = tmp_path / f"{stem.replace('__', '/')}.{suffix}"
            path.parent.mkdir(exist_ok=True)
            path.write_text(text)
            paths.append(path)
        return paths[0]

    return files


def xml(*trees: str, include: str = "", main: str = "") -> str:
    named = f' main_tree_to_execute="{main}"' if main else ""
    shown = "".join(f'<BehaviorTree ID="{name}">{NODE}</BehaviorTree>' for name in trees)
    lines = "".join(f'\n<include path="{path}"/>' for path in include.split())
    return f'<root BTCPP_format="4"{named}>{lines}\n{shown}</root>'


def yaml(body: str, include: str = "") -> str:
    return f"momantu_bt: 1\ninclude: [{include}]\n{body}\n"


def read(path: Path, registry: Registry | None = None) -> tuple[Document, list[Problem]]:
    document, problems = read_file(path, registry or Registry())
    return document, problems.sorted()


Write = Callable[..., Path]


def test_each_spelling_includes_the_other(write: Write, tmp_path: Path) -> None:
    path = write(
        main_yaml=yaml("main: A\ntrees: {A: [B, C, D]}", "parts/b.xml"),
        parts__b_xml=xml("B", include="../c.yml d.xml"),
        c_yml=yaml("world: nowhere\ntrees: {C: [D]}\nvalues: {v: 1}", "parts/d.xml"),
        parts__d_xml=xml("D"),
    )
    document, problems = read(path)
    assert problems == []
    assert list(document.trees) == ["A", "D", "C", "B"]
    assert [n.target for n in document.trees["A"].root.children] == ["B", "C", "D"]
    assert document.trees["C"].root.children[0].target == "D"
    assert (document.world, document.values) == (None, {})
    assert [i.path for i in document.includes] == ["parts/b.xml"]
    assert document.trees["D"].place.file == str(tmp_path / "parts/d.xml")
    assert set(document.source) == {tree.place.file for tree in document.trees.values()}
    assert check(document, Registry()).problems == []


def test_a_tree_below_runs_one_of_the_file_above(write: Write) -> None:
    path = write(
        main_xml=xml("A", include="b.yaml", main="B"),
        b_yaml=yaml("trees: {B: [A]}"),
    )
    document, problems = read(path)
    assert problems == []
    assert document.trees["B"].root.children[0].target == "A"


RUN_BY_ITSELF = """
main: Look
values: {rounds: 2}
trees:
  Look: [{wait: $rounds}, Shared, {set: {key: $never_read, value: 1}}]
  Shared: {wait: 1 s}
  Wrong: {wait: $nowhere}
"""


def test_what_nothing_here_runs_is_checked_with_its_own_file(write: Write) -> None:
    path = write(
        a_yaml=yaml("trees: {Main: [Shared]}", "b.yaml"),
        b_yaml=yaml(RUN_BY_ITSELF),
        c_yaml=yaml("trees: {Main: [Look]}", "b.yaml"),
    )
    assert load(str(path), Registry()).problems == []
    with pytest.raises(TreeError) as caught:
        load(str(path.with_name("b.yaml")), Registry())
    found = codes(caught.value.problems)
    assert ("read-before-write", "b.yaml", 9) in found
    assert ("unread-output", "b.yaml", 7) in found
    with pytest.raises(TreeError) as caught:
        load(str(path.with_name("c.yaml")), Registry())
    assert ("read-before-write", "b.yaml", 7) in codes(caught.value.problems)
    assert ("read-before-write", "b.yaml", 9) not in codes(caught.value.problems)


def test_an_own_tree_that_is_not_run_is_checked_with_all_it_runs(write: Write) -> None:
    path = write(
        a_yaml=yaml("main: A\ntrees: {A: succeed, Own: Below}", "b.yaml"),
        b_yaml=yaml("trees: {Below: {wait: $nowhere}}"),
    )
    with pytest.raises(TreeError) as caught:
        load(str(path), Registry())
    assert codes(caught.value.problems) == [
        ("unused-tree", "a.yaml", 4),
        ("read-before-write", "b.yaml", 3),
    ]


def test_ports_of_an_included_tree_type_the_attributes(write: Write) -> None:
    main = xml("A", include="b.yaml", main="A").replace(NODE, '<SubTree ID="B" at="5" n="5"/>')
    path = write(main_xml=main, b_yaml=yaml("trees: {B: {inputs: {at: text, n: int}, wait: 1 s}}"))
    document, problems = read(path)
    assert problems == []
    assert document.trees["A"].root.ports == {"at": Literal("5"), "n": Literal(5)}


def test_a_project_file_of_an_editor_has_no_tree_of_its_own(write: Write) -> None:
    path = write(
        p_btproj=xml(include="a.xml b.xml", main="B").replace(
            "</root>",
            '<TreeNodesModel><SubTree ID="A"><input_port name="x" type="int"/></SubTree>'
            "</TreeNodesModel></root>",
        ),
        a_xml=xml("A"),
        b_xml=xml("B").replace(NODE, '<SubTree ID="A" x="1"/>'),
    )
    document, problems = read(path)
    assert problems == []
    assert (document.main, set(document.trees)) == ("B", {"A", "B"})
    assert list(document.trees["A"].ports) == ["x"]
    assert not document.trees["A"].open


def codes(problems: list[Problem]) -> list[tuple[str, str, int]]:
    return [(p.code, Path(p.place.file).name, p.place.line) for p in problems]


def test_a_file_that_includes_itself(write: Write) -> None:
    path = write(
        a_yaml=yaml("trees: {A: [B]}", "b.xml"),
        b_xml=xml("B", include="c.yaml"),
        c_yaml=yaml("trees: {C: {wait: 1 s}}", "a.yaml"),
    )
    _, problems = read(path)
    assert codes(problems) == [("include-cycle", "c.yaml", 2)]
    assert "a.yaml -> " in problems[0].message
    assert "c.yaml -> " in problems[0].message


def test_the_same_name_is_reported_at_both_places(write: Write) -> None:
    path = write(
        a_yaml=yaml("main: A\ntrees: {A: [B], B: {wait: 1 s}}", "b.xml, c.xml"),
        b_xml=xml("B", "D"),
        c_xml=xml("D"),
    )
    _, problems = read(path)
    found = codes(problems)
    assert {(code, file) for code, file, _ in found} == {
        ("duplicate-tree", "a.yaml"),
        ("duplicate-tree", "b.xml"),
        ("duplicate-tree", "c.xml"),
    }


def test_the_same_file_twice_is_one_file(write: Write) -> None:
    path = write(
        a_yaml=yaml("trees: {A: [D]}", "b.xml, c.xml, ./b.xml"),
        b_xml=xml("B", include="d.xml"),
        c_xml=xml("C", include="d.xml"),
        d_xml=xml("D"),
    )
    assert read(path)[1] == []


@pytest.mark.parametrize(
    ("include", "message", "hint"),
    [
        ("grasp.xm", "there is no file", "did you mean grasp.xml?"),
        ("sub/grasp.xml", "there is no file", "tree files there: none"),
        ("../outside.xml", "not in the project", "below the project's folder"),
        ("/etc/passwd", "not in the project", ""),
        ("link.xml", "not in the project", ""),
        ("sub", "there is no file", ""),
        ("a\\0b", "there is no file", ""),
    ],
)
def test_files_that_cannot_be_included(
    include: str, message: str, hint: str, tmp_path: Path
) -> None:
    project = tmp_path / "project"
    (project / "sub").mkdir(parents=True)
    (project / "pyproject.toml").write_text("")
    (project / "grasp.xml").write_text(xml("G"))
    (tmp_path / "outside.xml").write_text(xml("O"))
    (project / "link.xml").symlink_to(tmp_path / "outside.xml")
    path = project / "main.yaml"
    path.write_text(yaml("trees: {A: {wait: 1 s}}", f'"{include}"'))
    _, problems = read(path)
    assert codes(problems) == [("include", "main.yaml", 2)]
    assert problems[0].place.column == 11
    assert message in problems[0].message
    assert hint in problems[0].hint


def test_without_a_project_the_files_folder_is_the_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inside = tmp_path / "trees"
    inside.mkdir()
    with monkeypatch.context() as patch:
        patch.setattr(includes, "_MARKS", ("a mark that no folder above has",))
        assert project_folder(inside / "a.yaml") == inside.resolve()
    (tmp_path / ".git").mkdir()
    assert project_folder(inside / "a.yaml") == tmp_path.resolve()


def test_problems_stand_in_their_own_file(write: Write) -> None:
    path = write(
        a_yaml=yaml("trees: {A: [B, {wait: 5 kg}]}", "b.xml"),
        b_xml=xml("B").replace(NODE, '\n<Sleep msec="1s"/>'),
    )
    with pytest.raises(TreeError) as caught:
        load(str(path), Registry())
    assert codes(caught.value.problems) == [
        ("wrong-value", "a.yaml", 3),
        ("wrong-value", "b.xml", 3),
    ]
    assert len(caught.value.source) == 2


def test_syntax_errors_of_included_files_are_reported_alone(write: Write) -> None:
    path = write(
        a_yaml=yaml("trees: {A: [B, C]}", "b.xml, c.yaml"),
        b_xml=xml("B").replace("</root>", ""),
        c_yaml="a: [",
    )
    with pytest.raises(TreeError) as caught:
        read(path)
    assert {(c, f) for c, f, _ in codes(caught.value.problems)} == {
        ("syntax", "b.xml"),
        ("syntax", "c.yaml"),
    }


def test_too_many_and_too_much(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(a_yaml=yaml("trees: {A: [B]}", "b.xml, c.xml"), b_xml=xml("B"), c_xml=xml("C"))
    monkeypatch.setattr(includes, "MAX_FILES", 2)
    assert codes(read(path)[1]) == [("too-large", "a.yaml", 2)]
    monkeypatch.setattr(includes, "MAX_FILES", 64)
    monkeypatch.setattr(includes, "MAX_TOTAL", 60)
    found = [code for code, _, _ in codes(read(path)[1])]
    assert "too-large" in found


def test_a_long_chain_of_files(write: Write) -> None:
    count = includes.MAX_FILES - 1
    texts = {
        f"f{i}_yaml": yaml(f"trees: {{T{i}: {{wait: 1 s}}}}", f"f{i + 1}.yaml")
        for i in range(count)
    }
    path = write(**texts, **{f"f{count}_yaml": yaml(f"trees: {{T{count}: {{wait: 1 s}}}}")})
    document, problems = read(path)
    assert problems == []
    assert len(document.trees) == includes.MAX_FILES


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("tree", xml("A")),
        ("tree.txt", "\n\t " + yaml("trees: {A: {wait: 1 s}}").strip()),
        ("tree.XML", xml("A")),
        ("tree.yml", yaml("trees: {A: {wait: 1 s}}")),
    ],
)
def test_the_spelling_by_suffix_or_by_content(name: str, text: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text.lstrip() if name.endswith("txt") else text)
    assert list(read(tmp_path / name)[0].trees) == ["A"]


def test_what_is_no_tree_file(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_bytes(b"<root>\n\xff</root>")
    with pytest.raises(TreeError, match="UTF-8"):
        read(tmp_path / "a.xml")
    with pytest.raises(TreeNotFound):
        read(tmp_path / "missing.xml")
    (tmp_path / "b.yaml").write_text("momantu_bt: 1\ninclude: [[a]]\ntrees: {A: {wait: 1 s}}\n")
    _, problems = read(tmp_path / "b.yaml")
    assert codes(problems) == [("include", "b.yaml", 2)]


def test_the_documents_own_includes_keep_their_places(write: Write) -> None:
    path = write(a_xml=xml("A", include="b.xml"), b_xml=xml("B"))
    include = read(path)[0].includes[0]
    assert include == Include("b.xml", include.place)
    assert (include.place.line, include.place.column, include.place.length) == (2, 16, 5)


def test_a_file_whose_only_tree_has_no_name(write: Write) -> None:
    path = write(main_xml=xml("", include="parts.xml"), parts_xml=xml(include="more.xml"))
    with pytest.raises(TreeError) as refused:
        load(str(path), Registry())
    assert "bad-name" in {problem.code for problem in refused.value.problems}
