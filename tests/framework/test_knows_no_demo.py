"""The framework names nothing of its own demo: no skill, service, code, robot, world or subtree.

Every text in `momantu_bt` is read: all string constants of its Python files, docstrings and help
included, and its templates. The names are those of what is installed, so a new skill or world is
looked for as soon as it has an entry point.

What is a name and what is a word of a sentence is told apart so:

- `detect_object`, `GoTo` and `PATH_BLOCKED` are nobody's words: they count wherever they stand;
- `pick`, `fetch` and `Put` are words too. They count where they can only be names: as the whole
  text, in backquotes, and in the forms of tree files, phases and command lines (`Put/x`,
  `after-pick`, `pick+2 s`, `pick.CODE`, `$@name`, `{pick: …}`, `--robot fetch`, `show pick`).

Codes of the engine, such as TIMEOUT, are the framework's own. OWN lists its own words that happen
to be names as well.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import momantu_bt
from momantu_bt.failure import ENGINE_CODES
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.load import load
from momantu_bt.tree.plugins import SERVICES, SKILLS
from momantu_bt.tree.registry import Registry
from momantu_bt.world_plugins import WORLDS

FOLDER = Path(momantu_bt.__file__).parent
OWN = {
    "check": "a verb of the command line",
    "mapping": "what YAML and JSON call keys with values",
    "operator": "the service through which a person drives, which the framework itself brings",
    "place": "a field of failures and problems, and what a text input may name",
}
TEMPLATES = (".txt", ".js", ".html")


@cache
def names() -> frozenset[str]:
    """All names of the demo."""
    found = {*SKILLS, *SERVICES, *ROBOTS, *WORLDS}
    found |= {code for skill in SKILLS.values() for code in skill.failures}
    registry = Registry.installed()
    for file in bundled().values():
        found |= set(load(str(file), registry).document.trees)
    return frozenset(found - set(ENGINE_CODES) - {"Main"})


def unmistakable(name: str) -> bool:
    """Whether no sentence has the name as a word."""
    return "_" in name or name.isupper() or re.search("[a-z][A-Z]", name) is not None


def either(words: Iterator[str]) -> str:
    return "|".join(sorted(map(re.escape, words), key=len, reverse=True))


@cache
def pattern() -> re.Pattern[str]:
    """Where a text names something of the demo."""
    whole = either(name for name in names() if unmistakable(name))
    words = either(name for name in names() if not unmistakable(name))
    others = either(name for name in names() if not unmistakable(name) and name not in OWN)
    return re.compile(
        rf"(?<!\w)(?:{whole})(?!\w)"
        rf"|\A(?:{others})\Z"
        rf"|`(?:{others})`"
        rf"|(?:[@/{{]|after-|- )(?:{others})(?![\w-])"
        rf"|(?:node: |--(?:robot|world) |(?:skills|robots|worlds) (?:show|test) )(?:{words})(?!\w)"
        rf"|(?<![\w-])(?:{words})(?:/[a-z]|#\d|\+\d|\.[A-Z])"
        rf"|(?<![\w-])(?:{others}): [$\"'{{a-z]"
    )


def texts(file: Path) -> Iterator[tuple[int, str]]:
    """Each text of a file, with its line."""
    content = file.read_text(encoding="utf-8")
    if file.suffix != ".py":
        yield from enumerate(content.splitlines(), 1)
        return
    for node in ast.walk(ast.parse(content)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.lineno, node.value


def mentions(text: str) -> list[str]:
    return [match.group() for match in pattern().finditer(text)]


FILES = sorted(
    file
    for file in FOLDER.rglob("*")
    if file.suffix in (".py", *TEMPLATES) and file.relative_to(FOLDER).parts[0] != "trees"
)


def test_no_text_of_the_framework_names_what_is_installed_beside_it() -> None:
    found = [
        f"{file.relative_to(FOLDER)}:{line}: {mention!r} in {text[:60]!r}"
        for file in FILES
        for line, text in texts(file)
        for mention in mentions(text)
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "text",
    [
        "detect_object",
        "raise it with PATH_BLOCKED",
        "SLIPPED",
        "pick",
        "see `pick`",
        "Put/navigate+2 s",
        "after-pick",
        "pick.SLIPPED",
        "$@localization.quality",
        "`- {node: place, status: FAILURE}`",
        "{pick: {object: $can}}",
        "navigate: {in_front_of: table_a}",
        "momantu-bt robots show fetch",
        "momantu-bt check bring_object --robot fetch",
        "worlds/four_rooms.yaml",
        "a key of the subtree GoTo",
    ],
)
def test_names_are_found(text: str) -> None:
    assert mentions(text)


@pytest.mark.parametrize(
    "text",
    [
        "check",
        "Put a record where the bench wants it",
        "pick one of them; in place of a skill",
        "the localization service",
        "fetch packages, and look at them",
        "TIMEOUT or SENSOR_DEAD",
        "momantu-bt worlds check FILE",
        "read-only",
    ],
)
def test_words_are_left_alone(text: str) -> None:
    assert not mentions(text)
