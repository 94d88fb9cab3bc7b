"""Slips of the pen in the bundled trees: nearly all are caught, in the line where they are.

Every slip is made at every place of the file where it can be made; those that leave YAML's
values as they were are none. What is known not to be caught is listed, with the reason.
"""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from momantu_bt.tree.check import check
from momantu_bt.tree.problems import Problem, TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.yaml_format import read
from momantu_bt.tree.yaml_source import YamlSyntaxError, compose, plain_value

TREES = Path(__file__).parents[3] / "trees"
MAY_BE_LEFT_OUT = {"side", "diameter", "height", "message", "recovery", "type", "default"}
FOUND_BY_THE_RUN = re.compile(
    r"check: (?!holding$|localized$)\w+"  # a question is a text until it is asked
    r"|message: failure"  # a dollar forgotten in free text is text
    r"|navigate: \{ ?(recovery|side)|navigate: \{[^,]*,\}"  # the goal is one of three inputs
    r"|find_apriltag: (?!.*\bon:)"  # optional too
)
"""Slips that no checker of the file alone can know, with the reason."""

Slip = Callable[[str], Iterator[str]]


def _each(pattern: str, change: Callable[[re.Match[str]], str], group: int = 1) -> Slip:
    """Change what a group of the pattern matches, at each of its places in a line."""

    def slips(line: str) -> Iterator[str]:
        for found in re.finditer(pattern, line):
            yield line[: found.start(group)] + change(found) + line[found.end(group) :]

    return slips


def _dropped(found: re.Match[str]) -> str:
    word = found[1]
    return word[: len(word) // 2] + word[len(word) // 2 + 1 :]


def _swapped(found: re.Match[str]) -> str:
    word = found[1]
    return word[:-2] + word[-1] + word[-2]


SLIPS: dict[str, Slip] = {
    "letter lost in a name before a colon": _each(r"([A-Za-z_]{4,})(?=:)", _dropped),
    "letters swapped in a name before a colon": _each(r"([A-Za-z_]{3,}[^\W_])(?=:)", _swapped),
    "letter lost in a bare node": _each(r"(?:^ *- |: )([a-z]{5,})$", _dropped),
    "letter lost in a wire": _each(r"\$(\w{4,})", _dropped),
    "letter lost in a part of a wire": _each(r"\$\w+\.(\w{3,})", _dropped),
    "letters swapped in a code": _each(r"\b([A-Z]{2,}_?[A-Z]*[A-Z])\b(?=.*:)", _swapped),
    "letter lost in a value": _each(r": ([a-z_]{4,})(?=[,}\n ]|$)", _dropped),
    "dollar forgotten": _each(r"(\$)\w", lambda _: ""),
    "braces instead of a dollar": _each(r"(\$\w+)\b(?!\.)", lambda m: f"{{{m[1][1:]}}}"),
    "another kind of unit": _each(r"\d (mm|s)\b", lambda m: {"mm": "kg", "s": "m"}[m[1]]),
    "unit mistyped": _each(r"\d (mm|s)\b", lambda m: f"{m[1]}c"),
    "text for a number": _each(r": (\d+)(?=[,}]|$)", lambda _: "many"),
    "half a number": _each(r"(?:attempts|side|tag_id): (\d+)", lambda m: f"{m[1]}.5"),
    "space after a colon forgotten": _each(r"\w:( )\S", lambda _: ""),
    "colon forgotten": _each(r"\w(:)(?= |$)", lambda _: ""),
    "comma forgotten": _each(r"(,)(?=[^#]*\})", lambda _: ""),
    "bar forgotten": _each(r"[A-Z]( \|) [A-Z]", lambda _: ""),
    "brace not closed": _each(r"(\})[^}]*$", lambda _: ""),
    "brace not opened": _each(r"(\{)", lambda _: ""),
    "quote not closed": _each(r": ([a-z_]+)$", lambda m: f'"{m[1]}'),
    "dash forgotten": _each(r"^ *(- )", lambda _: ""),
    "space after a dash forgotten": _each(r"^ *-( )", lambda _: ""),
    "one space too many": _each(r"^( +)\S", lambda m: m[1] + " "),
    "one space too few": _each(r"^( +)\S", lambda m: m[1][1:]),
    "a tab": _each(r"^( +)\S", lambda m: "\t" + m[1]),
    "input left out": _each(r"(?<=\{|,)( ?\w+: [^{},]+,?)(?=.*\})", lambda m: ""),
    "key written twice": _each(r"(?<=[{ ])(\w+: [^{},\n]+)(?=\})", lambda m: f"{m[1]}, {m[1]}"),
    "line written twice": _each(r"^( *\w.*)$", lambda m: f"{m[1]}\n{m[1]}"),
}


def mutants(text: str, slip: str) -> Iterator[tuple[int, str, str]]:
    """Line, the line after the slip, and the whole text after it; comments are left alone."""
    lines = text.splitlines()
    for index, line in enumerate(lines):
        code, mark, comment = line.partition("   #")
        if code.lstrip().startswith("#"):
            continue
        for changed in SLIPS[slip](code):
            after = [*lines[:index], changed + mark + comment, *lines[index + 1 :]]
            yield index + 1, changed, "\n".join(after) + "\n"


def problems_of(text: str, registry: Registry) -> list[Problem]:
    """Every problem of a text."""
    try:
        document, found = read(text, "t.yaml")
    except TreeError as error:
        return error.problems
    return check(document, registry, reading=found)


def same_values(left: str, right: str) -> bool:
    """Whether YAML reads the two alike."""
    try:
        return bool(plain_value(compose(left, "a")) == plain_value(compose(right, "b")))
    except YamlSyntaxError:
        return False


def is_excused(text: str, mutant: tuple[int, str, str], slip: str) -> bool:
    """Whether the values are what they were, or nobody can tell from the file."""
    line, changed, after = mutant
    if slip == "input left out":
        gone = set(re.findall(r"(\w+):", text.splitlines()[line - 1]))
        if (gone - set(re.findall(r"(\w+):", changed))) & MAY_BE_LEFT_OUT:
            return True
    if FOUND_BY_THE_RUN.search(changed):
        return True
    # only spaces, dashes and quotes can go without a trace; asking YAML each time is slow
    words = re.findall(r"\w+", changed) != re.findall(r"\w+", text.splitlines()[line - 1])
    return not words and "twice" not in slip and same_values(text, after)


def is_precise(problem: Problem, line: int, text: str, changed: str) -> bool:
    """Whether a problem leads to the slip in this line.

    It does from the line itself; from one that it names; from a use of the name that was slipped
    in, or its name; and where lines no longer hang together, from the line that follows.
    """
    if problem.place.line == line or re.search(rf"line {line}\b", problem.hint):
        return True
    lines = text.splitlines()
    if problem.code in ("syntax", "duplicate-key") and problem.place.line == line + 1:
        return True
    slipped = set(re.findall(r"\w+", lines[line - 1])) ^ set(re.findall(r"\w+", changed))
    there = lines[problem.place.line - 1 : problem.place.line]
    said = set(re.findall(r"\w+", "".join(there) + " " + problem.message))
    return bool(slipped & said)


def misses(name: str, slip: str, most: int, registry: Registry) -> tuple[int, list[str]]:
    """How many slips were made at up to `most` places of a tree, and those not caught."""
    text = (TREES / name).read_text(encoding="utf-8")
    made = list(mutants(text, slip))
    spread = made[:: max(1, -(-len(made) // most))]
    chosen = [mutant for mutant in spread if not is_excused(text, mutant, slip)]
    missed: list[str] = []
    for line, changed, after in chosen:
        found = problems_of(after, registry)
        if not any(is_precise(problem, line, text, changed) for problem in found):
            said = [f"{p.place.line}: {p.message}" for p in found]
            missed.append(f"{slip}, line {line}: {changed!r} gives {said}")
    return len(chosen), missed


@pytest.fixture(scope="module")
def installed() -> Registry:
    """The bundled skills, worlds and robots."""
    return Registry.installed()


@pytest.mark.parametrize(
    ("name", "most"), [("bring_object_plain.yaml", 6), ("bring_object.yaml", 3)]
)
def test_slips_are_caught_where_they_are(name: str, most: int, installed: Registry) -> None:
    total, missed = 0, list[str]()
    for slip in SLIPS:
        count, its = misses(name, slip, most, installed)
        total, missed = total + count, missed + its
    assert total > 80
    assert len(missed) <= total // 100, "\n".join(missed)
