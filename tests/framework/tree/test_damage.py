"""Files that are damaged or strange: refused in our words, never an exception of another kind."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from momantu_bt.formats.places import lines_of
from momantu_bt.formats.problems import Problem, show
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.tree.check.checker import check as check_document
from momantu_bt.tree.files.settings import Given, setting
from momantu_bt.tree.files.syntax import compose
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.load import TreeError, TreeNotFound, load, read_values
from momantu_bt.tree.model import Literal
from momantu_bt.tree.registry import Registry

Expect = Callable[..., None]
Check = Callable[[str], list[Problem]]
HEAD = "momantu_bt: 1\nworld: rooms\nmain: Main\n"
VOCABULARY = """
momantu_bt values trees inputs outputs Main Sub again any children child try catch
recover handle if then else while_do do for_each in as fail code message set key
sequence parallel wait retry timeout force skip_if on_success disabled name
navigate pick reset_pose say home door $a $b.x $@a $= $$ A_CODE 1 -2 1.5 true ~ 5
"""
SIGNS = ["'", '"', "&x", "*x", "<<", "?", "|", ">-", "!", "%", "---", "...", "# c", "\t", "é日"]
WORDS = [*VOCABULARY.split(), "3 cm", "$n := 1", "not $a", *SIGNS]
JOINTS = [": ", ", ", "{", "}", "[", "]", "\n", "\n  ", "\n    ", "\n      ", "- ", " ", "\r\n", ""]
SOUP = st.lists(st.sampled_from([*WORDS, *JOINTS, *JOINTS]), max_size=40).map("".join)

_leaf = st.sampled_from(WORDS).map(lambda word: f"{word!r}" if word in "'\"?|>-!%\t" else word)
NODES = st.recursive(
    _leaf,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: "[" + ", ".join(items) + "]"),
        st.lists(st.tuples(st.sampled_from(WORDS[:45]), inner), max_size=3).map(
            lambda pairs: "{" + ", ".join(f"{key}: {value}" for key, value in pairs) + "}"
        ),
    ),
    max_leaves=12,
)
"""Well-formed YAML of the language's own words, in all the wrong places."""


def assert_told_well(text: str, registry: Registry) -> None:
    """Whatever is wrong is told, at places that the text has."""
    try:
        document, found = read(text, "t.yaml")
        problems = check_document(document, registry, reading=found).problems
    except TreeError as error:
        problems = error.problems
        assert problems
    lines = lines_of(text)
    for problem in problems:
        place = problem.place
        assert 1 <= place.line <= len(lines), problem
        assert 1 <= place.column <= len(lines[place.line - 1]) + 2, problem
        assert problem.code in show(problem, {"t.yaml": text})
        assert "\x1b" not in show(problem, {"t.yaml": text})


@settings(max_examples=150, deadline=None)
@given(text=SOUP)
def test_any_soup_of_words_is_read_or_refused(text: str, registry: Registry) -> None:
    assert_told_well(text, registry)


@settings(max_examples=200, deadline=None)
@given(node=NODES)
def test_any_value_is_a_node_or_refused(node: str, registry: Registry) -> None:
    assert_told_well(f"{HEAD}trees:\n  Main: {node}\n", registry)


@settings(max_examples=80, deadline=None)
@given(header=NODES, key=st.sampled_from(["values", "trees", "main", "world", "momantu_bt"]))
def test_any_header_is_read_or_refused(header: str, key: str, registry: Registry) -> None:
    lines = {"momantu_bt": "1", "trees": "{Main: {wait: 1}}", key: header}
    assert_told_well("".join(f"{k}: {v}\n" for k, v in lines.items()), registry)


@settings(max_examples=60, deadline=None)
@given(ports=NODES, values=NODES)
def test_any_subtree_header_is_read_or_refused(ports: str, values: str, registry: Registry) -> None:
    sub = f"  Sub:\n    inputs: {ports}\n    outputs: {values}\n    wait: $a\n"
    assert_told_well(f"{HEAD}trees:\n  Main: [Sub: {values}]\n{sub}", registry)


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.binary(max_size=60))
def test_any_bytes_are_read_or_refused(data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "t.yaml"
    path.write_bytes(data)
    with pytest.raises(TreeError) as caught:
        load(str(path), Registry())
    assert caught.value.problems
    with suppress(TreeError):
        assert isinstance(read_values(path), Given)


@given(st.text(max_size=20))
def test_any_setting_is_read_or_refused(text: str) -> None:
    with suppress(ValueError):
        key, _ = setting(text)
        assert key == text.partition("=")[0].strip()


@pytest.mark.parametrize("break_", ["\r\n", "\r"])
def test_line_ends_change_no_place(break_: str, check: Check) -> None:
    text = HEAD + "trees:\n  Main:\n    - wat: 1\n    - wait: 3 m\n    - say: $x\n"
    wrong = "a: 1\nb: @\n"
    found, same = check(text), check(text.replace("\n", break_))
    assert [(p.code, p.place.line, p.place.column) for p in found] == [
        (p.code, p.place.line, p.place.column) for p in same
    ]
    assert check(wrong)[0].place == check(wrong.replace("\n", break_))[0].place


def test_a_control_character_after_old_line_ends_is_found_in_its_line(check: Check) -> None:
    (problem,) = check("a: 1\rb: 2\r\nc: \x01\n")
    assert (problem.place.line, problem.place.column) == (3, 4)


def test_a_byte_order_mark_changes_no_place(tmp_path: Path, registry: Registry) -> None:
    path = tmp_path / "t.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + b"momantu_bt: 2\ntrees: {A: {wait: 1}}\n")
    with pytest.raises(TreeError) as caught:
        load(str(path), registry)
    place = caught.value.problems[0].place
    assert (place.line, place.column) == (1, 13)


@pytest.mark.parametrize(
    ("body", "code", "hint"),
    [
        ("trees:\n  «Main»:\n", "not-a-node", "write its name"),
        ("trees: {Main: {if: {wait: 1}, then:« », else: {wait: 2}}}\n", "not-a-node", ""),
        ("trees:\n  Main:\n    - «roundrobin»: [{wait: 1}]\n", "unknown-node", "round_robin?"),
        ("trees:\n  Main:\n    - «sequnce»:\n      - wait: 1\n", "unknown-node", "sequence?"),
        ("trees:\n  Main:\n    - say: «[a, b]»\n", "wrong-value", "say: {port: value}"),
        (
            "trees: {Main: {recover: {attempts: 2, try: {wait: 1}, catch: {any: again},"
            " «catch»: {any: again}}}}\n",
            "duplicate-key",
            "line 4",
        ),
        (
            "trees: {Main: {recover: {attempts: 2, try: {wait: 1}, catch:"
            " {«'FAILED |'»: again}}}}\n",
            "bad-code",
            "`A | B` several",
        ),
        ("trees: {Main: {wait: «1e999»}}\n", "wrong-value", ""),
        ("trees: {Main: {wait: «1e999 s»}}\n", "wrong-value", ""),
    ],
)
def test_one_mistake_is_one_problem(expect: Expect, body: str, code: str, hint: str) -> None:
    expect(code, body, hint=hint)


@pytest.mark.parametrize(
    ("ports", "code", "message"),
    [
        ("{n: {type: pose2d, default: {x: 1, «x»: 2, y: 3}}}", "duplicate-key", "'x' stands"),
        ("{n: {type: int, default: «$m.x»}}", "wire-inside", "a default is a value, or one key"),
        ('{n: {type: text, default: «"at ${m}"»}}', "wire-inside", "or one key"),
        ("{n: {type: «[int]»}}", "wrong-value", "the name of a type"),
        ("[n, «n»]", "duplicate-key", "'n' stands here twice"),
        ("[n, «[m]»]", "wrong-value", "lists names"),
        ("[n, «{m: int}»]", "wrong-value", "lists names"),
        ("{n: any, «2»: int}", "bad-name", "'2' cannot be"),
    ],
)
def test_inputs_that_are_not_declared_well(
    expect: Expect, ports: str, code: str, message: str
) -> None:
    tree = "trees:\n  Main: [Sub: {n: {x: 1, y: 2}}]\n  Sub:\n"
    if "int, default" in ports or "text" in ports:
        tree = tree.replace("{x: 1, y: 2}", "1" if "int" in ports else "a")
    expect(code, f"{tree}    inputs: {ports}\n    wait: 1\n", message=message)


def test_a_default_may_hold_a_dollar(check: Check) -> None:
    tree = "trees:\n  Main: [Sub]\n  Sub:\n    inputs: {n: {type: text, default: $$5}}\n"
    document, problems = read(f"{HEAD}{tree}    say: $n\n", "t.yaml")
    assert problems.sorted() == []
    default = document.trees["Sub"].ports["n"].default
    assert default == Literal("$5")


@pytest.mark.parametrize("version", ["true", "1.0", "01", "'1 '", "[1]", "~"])
def test_the_version_is_the_number_one(version: str, check: Check) -> None:
    found = check(f"momantu_bt: {version}\ntrees: {{Main: {{wait: 1}}}}\n")
    assert [problem.code for problem in found] == ["wrong-version"]


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("- sequence\n    - a\n    - b: c\n", "line 1: write `sequence:`"),
        ("A | B\n  - a\n  - b: c\n", "line 1: a `:` may be missing there"),
        ("- a\n- b\n  c: 1\n", "line 2: write `b:`"),
        ('a: "b\nc: 1\nd: \'x\' "y"\n', "line 1 opens a quote"),
        ("a: it's\nb: c: d\n", "check the indentation"),
        ("a: 1\n  # note\nb: c: d\n", "check the indentation"),
        ("x: 1\n- b\n", "line 1 begins it in column 1"),
        ("- a\nb: 1\n", "line 1 begins it in column 1"),
    ],
)
def test_a_syntax_error_names_the_line_that_caused_it(text: str, hint: str) -> None:
    with pytest.raises(YamlSyntaxError) as caught:
        compose(text, "t.yaml")
    assert hint in caught.value.problem.hint


@pytest.mark.parametrize("name", ["x" * 5000, "a\0b", "", "/dev/null", "\udcff.yaml"])
def test_names_that_can_be_no_file(name: str) -> None:
    with pytest.raises(TreeNotFound) as caught:
        load(name, Registry())
    assert str(caught.value)
