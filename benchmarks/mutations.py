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
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from slips.judging import judge, leads_to
from slips.trees import BLOCKS, GOOD_TREES, GoodTree, Mutant, good_trees, mutants, structural
from slips.xml import XML_SLIPS
from slips.yaml import SLIPS

from momantu_bt.formats.problems import errors
from momantu_bt.tree.registry import Registry


@dataclass
class Tally:
    """Verdicts of one kind of slip, the errors of each one that was found, and what was not."""

    verdicts: Counter[str] = field(default_factory=Counter)
    errors: list[int] = field(default_factory=list)
    told: list[str] = field(default_factory=list)

    @property
    def mistakes(self) -> int:
        """Slips that count."""
        return sum(self.verdicts[name] for name in ("right", "elsewhere", "missed"))

    @property
    def caught(self) -> int:
        """Those found before the first tick."""
        return self.verdicts["right"] + self.verdicts["elsewhere"]


def kinds() -> list[str]:
    """Every kind of slip."""
    return [*SLIPS, *BLOCKS, "tree that runs itself", *XML_SLIPS]


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
            if verdict in ("right", "elsewhere"):
                tally.errors.append(len(errors(tree.problems(mutant.text)[1])))
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
        total.errors += tally.errors
        print(_row(kind, tally))
    print(_row("all", total))
    counts = sorted(total.errors)
    few = sum(count <= 3 for count in counts) / len(counts)
    middle = counts[len(counts) // 2]
    print(f"errors of one slip: median {middle}, at most 3 in {few:.1%}, most {counts[-1]}")
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
