"""Every code has a page; its wrong example has that problem there, its right one has none."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.plugins import PluginError
from momantu_bt.testing import armless_robot
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.files.xml import format as xml_format
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.load import read_file
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.show.problem_pages import UnknownCode, codes, explanation, pages_folder
from momantu_bt.tree.substitute.substitution import load_substitution
from momantu_bt.world import WorldError

MARK = "<- wrong"
HEADER = "momantu_bt: 1\nworld: four_rooms\ntrees:\n  Main:\n    - reset_pose: home\n"


def problems(text: str, registry: Registry | None = None, **asked: Any) -> list[Problem]:
    try:
        reader = xml_format.read if text.startswith("<") else read
        document, reading = reader(text, "example")
    except TreeError as error:
        return error.problems
    return check(document, registry or Registry.installed(), reading=reading, **asked).problems


def examples(kind: str) -> Mapping[str, str]:
    """The first fenced tree below `Wrong:` or `Right:`, by code."""
    found = {}
    for code in codes():
        block = re.search(rf"^{kind}:\n\n```(?:yaml|xml)\n(.*?)```", explanation(code), re.S | re.M)
        if block is not None:
            found[code] = block[1]
    return found


@pytest.mark.parametrize("code", examples("Wrong"))
def test_the_wrong_example_has_this_problem_at_its_mark(code: str) -> None:
    example = examples("Wrong")[code]
    line = next(n for n, text in enumerate(example.splitlines(), 1) if MARK in text)
    found = problems(example)
    assert (code, line) in {(problem.code, problem.place.line) for problem in found}
    others = {p.code for p in found if p.severity is Severity.ERROR} - {code}
    assert not others, "the example shows more than one problem"


@pytest.mark.parametrize("code", codes())
def test_the_right_example_has_no_problem(code: str) -> None:
    assert problems(examples("Right")[code]) == []


def broken(error: Exception) -> Any:
    def fails(*arguments: Any) -> Any:
        raise error

    return fails


class Shaky(dict[str, Any]):
    """Skills of which one cannot be loaded."""

    def __contains__(self, name: object) -> bool:
        return name == "reset_pose"

    def __getitem__(self, name: str) -> Any:
        raise PluginError("no such module")


@dataclass
class World:
    default_robot: str = "fetch"
    site: Callable[[], Any] = lambda: None


def included_by_itself() -> list[Problem]:
    with TemporaryDirectory() as folder:
        file = Path(folder, "a.yaml")
        file.write_text("momantu_bt: 1\ninclude: [a.yaml]\ntrees: {Main: {wait: 1 s}}\n")
        return read_file(file, Registry())[1].sorted()


def of_a_rule(rule: str) -> list[Problem]:
    """Problems of a rule for a tree of one skill."""
    with TemporaryDirectory() as folder:
        rules = Path(folder) / "rules.yaml"
        rules.write_text(f"momantu_bt: 1\nsubstitute: [{{{rule}}}]\n", encoding="utf-8")
        document, _ = read(HEADER, "example.yaml")
        try:
            load_substitution(rules, document, Registry.installed())
        except TreeError as error:
            return error.problems
    return []


WITHOUT_A_TREE = {
    "include-cycle": included_by_itself,
    "unmatched-rule": lambda: of_a_rule("node: reset_pos, status: SUCCESS"),
    "undeclared-code": lambda: of_a_rule("node: reset_pose, status: FAILURE, code: BROKEN"),
    "too-large": lambda: problems("[" * 200),
    "unknown-robot": lambda: problems(HEADER, robot="fecth"),
    "broken-plugin": lambda: problems(
        HEADER, Registry(skills=Shaky(), worlds={"four_rooms": World()})
    ),
    "broken-world": lambda: problems(
        HEADER, Registry(worlds={"four_rooms": World(site=broken(RuntimeError("no map")))})
    ),
    "broken-robot": lambda: problems(
        HEADER, Registry(worlds={"four_rooms": World()}, robots={"fetch": broken(OSError("gone"))})
    ),
    "robot-lacks": lambda: problems(
        HEADER,
        Registry(
            skills=Registry.installed().skills,
            worlds={"four_rooms": World()},
            robots={"fetch": armless_robot},
        ),
    ),
    "robot-not-installed": lambda: problems(
        HEADER,
        Registry(worlds={"four_rooms": World()}, robots={"fetch": broken(WorldError("no meshes"))}),
    ),
}
"""Problems that no tree file has by itself."""


@pytest.mark.parametrize("code", WITHOUT_A_TREE)
def test_problems_of_what_is_installed(code: str) -> None:
    assert code in {problem.code for problem in WITHOUT_A_TREE[code]()}


def test_every_code_is_shown_by_an_example_or_a_case() -> None:
    elsewhere = {"unknown-value"}  # of `--set`; tests/framework/tree/test_load.py
    assert set(codes()) == set(examples("Wrong")) | set(WITHOUT_A_TREE) | elsewhere


def test_each_page_begins_with_its_code_and_one_sentence() -> None:
    for code, sentence in codes().items():
        assert explanation(code).startswith(f"# {code}\n\n")
        assert sentence.endswith(".")
        assert len(sentence) < 140


def test_an_unknown_code() -> None:
    with pytest.raises(UnknownCode):
        explanation("unknwon-node")


def test_the_index_links_every_page() -> None:
    index = Path(pages_folder() / "index.md").read_text(encoding="utf-8")
    assert re.findall(r"\[`([\w-]+)`\]\(\1\.md\)", index) == list(codes())
