"""How many of the mistakes that people make in a tree file the checker finds, and where it says so.

    python benchmarks/mutations.py
    python benchmarks/mutations.py --most 20 --missed

Every kind of slip is made at every place of every good tree where it can be made (`--most` takes
that many places per tree and kind, spread evenly). A slip is no mistake, and is not counted, when

- the file still means the same: the document read from it equals the one before, a list of one
  node counting as that node (`same`);
- it lies in free text, which only a person can judge: a comment, a name, a note, a message, an
  input of type text that names nothing of the world, or a code that the tree itself makes up and
  no handler answers (`free`);
- what was left out may be left out: an input with a default, an output, a case (`allowed`).

All others count. One is found when there is an error before the first tick. The place is right
when an error stands in the line of the slip, or names that line, or stands where the name that was
slipped is used (a declaration mistyped is found at its uses); where a line no longer hangs
together with the ones around it, YAML can often tell only at the next line, which counts too.
"""

from __future__ import annotations

import argparse
import random
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from pathlib import Path
from typing import Literal, TypeAlias

from xml_slips import XML_SLIPS, Slip, each, lost, swapped

from momantu_bt.messages import VALUE_TYPES
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import MODIFIERS, SUBTREE, CodeText
from momantu_bt.tree.check import check
from momantu_bt.tree.model import Document, Node, Place
from momantu_bt.tree.problems import Problem, Problems, TreeError, errors
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.signatures import Context
from momantu_bt.tree.xml.format import read as read_xml
from momantu_bt.tree.xml.writer import write as write_xml
from momantu_bt.tree.yaml.format import read as read_yaml

ROOT = Path(__file__).resolve().parent.parent
GOOD_TREES = (
    *sorted((ROOT / "trees").rglob("*.yaml")),
    *sorted((ROOT / "tests" / "framework" / "tree" / "good_trees").glob("*.yaml")),
)
Verdict: TypeAlias = Literal["right", "elsewhere", "missed", "same", "free", "allowed"]
KEYBOARD = ("qwertyuiop", "asdfghjkl", "zxcvbnm")


@dataclass(frozen=True)
class Mutant:
    """A tree with one slip. line: where, from 1. changed: that line after the slip."""

    kind: str
    line: int
    changed: str
    text: str


@dataclass
class GoodTree:
    """A tree without problems, and what is known of its places.

    as_xml: written in the other spelling. free: where free text stands. optional: places of the
    names of ports that may be left out.
    """

    path: Path
    registry: Registry
    as_xml: bool = False
    text: str = ""
    document: Document = field(init=False)
    free: list[Place] = field(default_factory=list)
    optional: set[tuple[int, int]] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.text = self.text or self.path.read_text(encoding="utf-8")
        if self.as_xml:
            plain = read_yaml(self.text, "t.yaml")[0]
            check(plain, self.registry)
            self.text = write_xml(plain, self.registry)
        self.document, reading = self.read(self.text)
        wrong = check(self.document, self.registry, reading=reading)
        assert not wrong, f"{self.path}: {wrong[0].place}: {wrong[0].message}"
        context = Context(self.document, self.registry, Problems())
        for tree in self.document.trees.values():
            for node in tree.root.walk():
                self._note(context, node)
            for port in tree.ports.values():
                if port.direction == "in" and port.default is None:
                    continue
                self.optional.add((port.place.line, 0))

    @property
    def slips(self) -> dict[str, Slip]:
        """What can go wrong in a line of its spelling."""
        return XML_SLIPS if self.as_xml else SLIPS

    def read(self, text: str) -> tuple[Document, Problems]:
        """Read a text in its spelling; TreeError where that cannot be done."""
        return read_xml(text, "t.xml", self.registry) if self.as_xml else read_yaml(text, "t.yaml")

    def problems(self, text: str) -> tuple[Document | None, list[Problem]]:
        """What is read from a text, and every problem that it has."""
        try:
            document, found = self.read(text)
        except TreeError as error:
            return None, error.problems
        return document, check(document, self.registry, reading=found)

    def _note(self, context: Context, node: Node) -> None:
        signature = context.signature(node)
        ports = signature.ports if signature is not None else {}
        for name, place in node.port_places.items():
            port = ports.get(name)
            if port is not None and _is_free_text(port) and node.type != SUBTREE:
                self.free.append(place)
            if port is not None and not port.required:
                at = node.port_name_places.get(name, place)
                self.optional.add((at.line, at.column))


OPTIONAL_FIELDS = {
    "type",
    "editable",
    *(
        item.name
        for type_ in VALUE_TYPES.values()
        if is_dataclass(type_)
        for item in fields(type_)
        if item.default is not MISSING or item.default_factory is not MISSING
    ),
}
"""Parts of values that have a default; in a model of XML a port's type, which is any then."""


def _is_free_text(port: Port) -> bool:
    """A text that names nothing, or a code that the tree gives its own failure."""
    texts = port.type in (str, tuple[str, ...]) and port.names is None
    free = port.type is CodeText or texts
    return port.direction == "in" and free


# slips of one line


def doubled(found: re.Match[str]) -> str:
    word = found[1]
    return word[: len(word) // 3 + 1] + word[len(word) // 3 :]


def neighbour(found: re.Match[str]) -> str:
    """One letter typed beside its key."""
    word = found[1]
    at = len(word) // 2
    row = next((row for row in KEYBOARD if word[at].lower() in row), None)
    if row is None:
        return word[:at] + "x" + word[at + 1 :]
    beside = row[(row.index(word[at].lower()) + 1) % len(row)]
    return word[:at] + (beside.upper() if word[at].isupper() else beside) + word[at + 1 :]


TYPOS = (lost, swapped, doubled, neighbour)
_MODIFIERS = "|".join(sorted(MODIFIERS))

SLIPS: dict[str, Slip] = {
    "typo in a key": each(r"([A-Za-z_]{4,})(?=:)", *TYPOS),
    "typo in a modifier": each(rf"^ +({_MODIFIERS})(?=:)", *TYPOS),
    "typo in a bare node": each(r"(?:^ *- |: |, |\[)([A-Za-z_]{5,})(?=$|,|\])", *TYPOS),
    "typo in a wire": each(r"\$\{?@?(\w{4,})", *TYPOS),
    "typo in a part of a wire": each(r"\$@?\w+\.(\w{3,})", *TYPOS),
    "typo in a code": each(r"\b([A-Z]{2,}_[A-Z_]*[A-Z])\b(?=.*:)", *TYPOS),
    "typo in a value": each(r": ([a-z_]{4,})(?=[,}\n ]|$)", *TYPOS),
    "capital letter": each(r"([a-z])\w{3,}(?=:)", lambda m: m[1].upper()),
    "dash for an underscore": each(r"\w(_)\w+(?=:)", lambda _: "-"),
    "dollar forgotten": each(r"(\$@?)\w", lambda _: ""),
    "dollar too much": each(r": ()[a-z_]{3,}(?=[,}]|$)", lambda _: "$"),
    "braces for a dollar": each(r"(\$\w+)\b(?!\.)", lambda m: f"{{{m[1][1:]}}}"),
    "another kind of unit": each(
        r"\d (mm|cm|m|s|min|Hz)\b", lambda m: "kg" if m[1] in ("mm", "cm", "m") else "m"
    ),
    "typo in a unit": each(r"\d (mm|cm|min|s|m)\b", lambda m: f"{m[1]}c"),
    "comma in a number": each(r": \d+(\.)\d", lambda _: ","),
    "text for a number": each(r": (\d+(?: \w+)?)(?=[,}]|$)", lambda _: "many"),
    "number for a text": each(r": ([a-z_]{4,})(?=[,}]|$)", lambda _: "5"),
    "list for a value": each(r": (\$?\w+)(?=[,}]|$)", lambda m: f"[{m[1]}]"),
    "half a number": each(r"(?:attempts|side|tag_id|retry|repeat): (\d+)", lambda m: f"{m[1]}.5"),
    "yes for true": each(r": (true|false)(?=[,}]|$)", lambda m: "yes" if m[1] == "true" else "no"),
    "space after a colon forgotten": each(r"\w:( )\S", lambda _: ""),
    "colon forgotten": each(r"\w(:)(?= |$)", lambda _: ""),
    "equals for a colon": each(r"\w(: )(?=\S)", lambda _: "="),
    "comma forgotten": each(r"(,)(?=[^#]*\})", lambda _: ""),
    "bar forgotten": each(r"[A-Z]( \|) [A-Z]", lambda _: ""),
    "bracket not closed": each(r"([\}\]])[^}\]]*$", lambda _: ""),
    "bracket not opened": each(r"([\{\[])", lambda _: ""),
    "quote not closed": each(r": ([a-z_]+)$", lambda m: f'"{m[1]}'),
    "quotes forgotten": each(r'("[^"]*[:#{\[][^"]*")', lambda m: m[1][1:-1]),
    "dash forgotten": each(r"^ *(- )", lambda _: ""),
    "dash too much": each(r"^ +()[a-z_]+:", lambda _: "- "),
    "space after a dash forgotten": each(r"^ *-( )", lambda _: ""),
    "one space too many": each(r"^( +)\S", lambda m: m[1] + " "),
    "one space too few": each(r"^( +)\S", lambda m: m[1][1:]),
    "one level too far in": each(r"^( +)\S", lambda m: m[1] + "  "),
    "one level too far out": each(r"^( {2,})\S", lambda m: m[1][2:]),
    "a tab": each(r"^( +)\S", lambda m: "\t" + m[1]),
    "input left out": each(r"(?<=\{|,)( ?\w+: [^{},]+,?)(?=.*\})", lambda _: ""),
    "key written twice": each(r"(?<=[{ ])(\w+: [^{},\n]+)(?=\})", lambda m: f"{m[1]}, {m[1]}"),
    "line written twice": each(r"^( *\w[^-].*)$", lambda m: f"{m[1]}\n{m[1]}"),
    "modifier among the ports": each(r"^ +- (?!if)\w+: \{[^{}]+(\})$", lambda _: ", retry: 3}"),
    "script without a dollar": each(r"(?:_if|condition|script): .*(\$)\w", lambda _: ""),
    "signs the wrong way round": each(
        r" ([<>]=|==) ", lambda m: "=>" if m[1] == "==" else "=" + m[1][0]
    ),
    "children left out": each(
        r"^ +- (?:sequence|fallback|parallel|round_robin)(:)$", lambda _: ": []  # "
    ),
}


def mutants(tree: GoodTree, kind: str) -> Iterator[Mutant]:
    """One kind of slip at every place of a tree; comments are left alone."""
    lines = tree.text.splitlines()
    for index, line in enumerate(lines):
        code, mark, comment = line.partition(" <!--" if tree.as_xml else " #")
        if code.lstrip().startswith(("#", "<!--", "<?")):
            continue
        for changed in tree.slips[kind](code):
            after = [*lines[:index], changed + mark + comment, *lines[index + 1 :]]
            yield Mutant(kind, index + 1, changed, "\n".join(after) + "\n")


def structural(tree: GoodTree) -> Iterator[Mutant]:
    """Slips of more than a line: trees that run themselves, nodes without their companion."""
    if tree.as_xml:
        return
    lines = tree.text.splitlines()
    for name, each_tree in tree.document.trees.items():
        for node in each_tree.root.walk():
            place = node.place
            line = lines[place.line - 1]
            bare = re.match(r"^( *- )\w", line)
            if bare is not None and place.column == len(bare[1]) + 1 and not node.children:
                after = [*lines[: place.line], f"{bare[1]}{name}", *lines[place.line :]]
                yield Mutant("tree that runs itself", place.line + 1, f"{name}", "\n".join(after))
    for index, line in enumerate(lines):
        for kind, pattern in _BLOCKS.items():
            if re.match(pattern, line):
                end = _block_end(lines, index)
                after = [*lines[:index], *lines[end:]]
                yield Mutant(kind, index + 1, line, "\n".join(after) + "\n")


_BLOCKS = {
    "catch left out": r"^ +catch:\s*$",
    "try left out": r"^ +try:",
    "then left out": r"^ +(then|do):",
    "trees left out": r"^trees:\s*$",
}


def _block_end(lines: Sequence[str], start: int) -> int:
    """Index of the first line after a block."""
    indent = len(lines[start]) - len(lines[start].lstrip())
    for index in range(start + 1, len(lines)):
        text = lines[index].strip()
        if text and len(lines[index]) - len(lines[index].lstrip()) <= indent:
            return index
    return len(lines)


# judging


def meaning(document: Document) -> list[object]:
    """What a document says, without frames around one node; two that mean the same are equal."""
    said: list[object] = [document.main, document.world, document.values, document.includes]
    for tree in document.trees.values():
        said += [tree.name, list(tree.ports.values())]
        for node in tree.root.walk():
            if node.type == "Sequence" and len(node.children) == 1 and not node.conditions:
                continue
            handlers = [handler.codes for handler in node.handlers]
            said.append((node.type, node.target, node.ports, len(node.children), handlers))
            said.append((node.conditions, node.disabled, node.name))
    return said


def judge(tree: GoodTree, mutant: Mutant) -> Verdict:
    """Whether the slip is a mistake, and if so whether and where it was found."""
    document, problems = tree.problems(mutant.text)
    wrong = errors(problems)
    if wrong:
        old = (*tree.text.splitlines(), "")[mutant.line - 1]
        right = any(leads_to(problem, mutant, old) for problem in wrong)
        return "right" if right else "elsewhere"
    if document is not None and meaning(document) == meaning(tree.document):
        return "same"
    if is_free(tree, mutant):
        return "free"
    return "allowed" if is_allowed(tree, mutant) else "missed"


def leads_to(problem: Problem, mutant: Mutant, old: str) -> bool:
    """Whether a problem leads a person to the slip."""
    line = mutant.line
    if problem.place.line == line or re.search(rf"\bline {line}\b", problem.hint):
        return True
    if mutant.kind in _BLOCKS or mutant.kind in ("line written twice", "tree that runs itself"):
        return abs(problem.place.line - line) <= 1 or mutant.kind in _BLOCKS
    if problem.code in ("syntax", "duplicate-key") and problem.place.line == _next(mutant):
        return True
    slipped = set(re.findall(r"\w+", old)) ^ set(re.findall(r"\w+", mutant.changed))
    there = mutant.text.splitlines()[problem.place.line - 1 : problem.place.line]
    said = set(re.findall(r"\w+", "".join(there) + " " + problem.message + " " + problem.hint))
    return bool(slipped & said)


def _next(mutant: Mutant) -> int:
    """The next line after the slip on which something stands."""
    below = enumerate(mutant.text.splitlines()[mutant.line :], mutant.line + 1)
    return next((number for number, text in below if text.strip()), mutant.line + 1)


def _span(old: str, new: str) -> tuple[int, int]:
    """The stretch of the old line that a slip changed; from 0, end excluded."""
    start = 0
    while start < min(len(old), len(new)) and old[start] == new[start]:
        start += 1
    end = 0
    while end < min(len(old), len(new)) - start and old[-1 - end] == new[-1 - end]:
        end += 1
    return start, len(old) - end


def is_free(tree: GoodTree, mutant: Mutant) -> bool:
    """Whether the slip lies wholly in text for people."""
    old = tree.text.splitlines()[mutant.line - 1].partition(" #")[0]
    start, end = _span(old, mutant.changed)
    if re.match(r"\s*(- )?(name|note|doc|message|question|text): ", old):
        return start >= old.index(": ")
    return any(
        place.line == mutant.line
        and place.column - 1 <= start
        and end <= place.column - 1 + place.length
        for place in tree.free
    )


def is_allowed(tree: GoodTree, mutant: Mutant) -> bool:
    """Whether what was left out may be left out."""
    if mutant.kind.endswith("left out"):
        old = tree.text.splitlines()[mutant.line - 1].partition(" #")[0]
        if re.match(r"\s*cases:", old):
            return True
        start, end = _span(old, mutant.changed)
        found = (match.start() for match in re.finditer(r"[\w:]+(?==)|\w+(?=:)", old))
        names = [at for at in found if start - 1 <= at < end]
        if all(re.match(r"[\w:]+", old[at:])[0] in OPTIONAL_FIELDS for at in names):
            return True
        places = tree.optional
        return all((mutant.line, at + 1) in places or (mutant.line, 0) in places for at in names)
    return False


@dataclass
class Tally:
    """Verdicts of one kind of slip, and what was missed or told elsewhere."""

    verdicts: Counter[str] = field(default_factory=Counter)
    told: list[str] = field(default_factory=list)

    @property
    def mistakes(self) -> int:
        """Slips that count."""
        return sum(self.verdicts[name] for name in ("right", "elsewhere", "missed"))

    @property
    def caught(self) -> int:
        """Those found before the first tick."""
        return self.verdicts["right"] + self.verdicts["elsewhere"]


def good_trees(registry: Registry, paths: Sequence[Path] = GOOD_TREES) -> list[GoodTree]:
    """Every good tree, in both spellings."""
    return [GoodTree(path, registry, as_xml) for as_xml in (False, True) for path in paths]


def kinds() -> list[str]:
    """Every kind of slip."""
    return [*SLIPS, *_BLOCKS, "tree that runs itself", *XML_SLIPS]


def made(tree: GoodTree, most: int | None) -> Iterator[Mutant]:
    """The mutants of a tree: at most so many of each kind, spread over the file."""
    of_kind: dict[str, list[Mutant]] = {kind: list(mutants(tree, kind)) for kind in tree.slips}
    for mutant in structural(tree):
        of_kind.setdefault(mutant.kind, []).append(mutant)
    for found in of_kind.values():
        step = 1 if most is None else max(1, -(-len(found) // most))
        yield from found[::step]


def corpus(trees: Iterable[GoodTree], most: int | None = None) -> dict[str, Tally]:
    """The verdicts on every mutant, by kind."""
    tallies = {kind: Tally() for kind in kinds()}
    for tree in trees:
        for mutant in made(tree, most):
            verdict = judge(tree, mutant)
            tally = tallies[mutant.kind]
            tally.verdicts[verdict] += 1
            if verdict in ("missed", "elsewhere"):
                place = f"{tree.path.name}:{mutant.line}"
                tally.told.append(f"{verdict:9} {mutant.kind}: {place}: {mutant.changed.strip()}")
    return tallies


def several(tree: GoodTree, count: int, seed: int) -> tuple[int, int]:
    """Files with three slips of one line each: how many there were, and how many told all three.

    Slips after which the file is no YAML are left out, since those are told alone.
    """
    generator = random.Random(seed)
    alone = [
        mutant
        for mutant in made(tree, 6)
        if "\n" not in mutant.changed and mutant.kind in tree.slips and _is_told(tree, mutant)
    ]
    whole, files = 0, 0
    lines = tree.text.splitlines()
    for _ in range(count):
        chosen = {mutant.line: mutant for mutant in generator.sample(alone, 3)}
        changed = [
            chosen[number].changed if number in chosen else line
            for number, line in enumerate(lines, 1)
        ]
        document, problems = tree.problems("\n".join(changed) + "\n")
        if document is None:
            continue
        files += 1
        wrong = errors(problems)
        whole += all(
            any(leads_to(problem, mutant, lines[line - 1]) for problem in wrong)
            for line, mutant in chosen.items()
        )
    return files, whole


def _is_told(tree: GoodTree, mutant: Mutant) -> bool:
    document, problems = tree.problems(mutant.text)
    return document is not None and any(p.place.line == mutant.line for p in errors(problems))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--most", type=int, help="places per tree and kind; else all")
    parser.add_argument("--missed", action="store_true", help="print what was not found")
    parser.add_argument("--trees", type=Path, nargs="+", default=list(GOOD_TREES))
    asked = parser.parse_args()
    registry = Registry.installed()
    trees = good_trees(registry, asked.trees)
    tallies = corpus(trees, asked.most)
    print(f"{'slip':32} mistakes  found  right line   same  free  allowed")
    total = Tally()
    for kind, tally in tallies.items():
        total.verdicts += tally.verdicts
        print(_row(kind, tally))
    print(_row("all", total))
    if asked.missed:
        print("\n".join(line for tally in tallies.values() for line in tally.told))
    pairs = [several(tree, 40, seed=0) for tree in trees]
    files, whole = (sum(column) for column in zip(*pairs, strict=True))
    print(f"three slips in one file: all three told in {whole} of {files}")


def _row(kind: str, tally: Tally) -> str:
    v, mistakes = tally.verdicts, tally.mistakes
    found = f"{tally.caught / mistakes:6.1%}" if mistakes else "     -"
    right = f"{v['right'] / mistakes:6.1%}" if mistakes else "     -"
    return (
        f"{kind:32} {mistakes:8d} {found}      {right} {v['same']:6d}{v['free']:6d}"
        f"{v['allowed']:9d}"
    )


if __name__ == "__main__":
    main()
