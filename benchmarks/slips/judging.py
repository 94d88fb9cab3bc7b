"""Whether a slip is a mistake, and if so whether it is found and where."""

from __future__ import annotations

import re
from typing import Literal, TypeAlias

from momantu_bt.formats.problems import Problem, errors
from momantu_bt.tree.model import Document
from slips.trees import BLOCKS, OPTIONAL_FIELDS, GoodTree, Mutant

Verdict: TypeAlias = Literal["right", "elsewhere", "missed", "same", "free", "allowed"]


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
    if mutant.kind in BLOCKS or mutant.kind in ("line written twice", "tree that runs itself"):
        return abs(problem.place.line - line) <= 1 or mutant.kind in BLOCKS
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
