"""Check the phases of faults against a tree, and choose the usual phase of a kind of fault."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase
from typing import TypeAlias

from momantu_bt.fault import FaultError
from momantu_bt.fault_kind import FaultKind
from momantu_bt.faults.kinds.triggers import usual_phases
from momantu_bt.faults.phase import START, Phase, parse_phase
from momantu_bt.formats.names import valid_names
from momantu_bt.skill import Skill
from momantu_bt.tree.catalogue import NODES, SUBTREE
from momantu_bt.tree.model import Document, Node
from momantu_bt.tree.substitute.substitution import Substitution, names, reached

Skills: TypeAlias = Mapping[str, type[Skill]]


def usual_phase(
    kind: FaultKind,
    document: Document,
    skills: Skills,
    substitution: Substitution,
    told: str | None = None,
) -> str:
    """The first of a kind's phases that the run can reach; else the start.

    skills: those that the run can reach, in the order of the file. told: the phase in the
    tree's own file of faults; it comes first.
    """
    own: tuple[str, ...] = () if told is None else (told,)
    for text in (*own, *usual_phases(kind.begins, skills)):
        if _fits(parse_phase(text), document, substitution):
            return text
    return START


def check_phase(text: str, document: Document, substitution: Substitution) -> Phase:
    """A phase of a fault of this tree.

    Raises:
        FaultError: the tree has no such names; the message says which, and what would be valid.
    """
    phase = parse_phase(text)
    if _fits(phase, document, substitution):
        return phase
    found = [name for name in phase.names if _named(name, document, substitution)]
    missing = next((name for name in phase.names if name not in found), None)
    if missing is None:
        way = " inside of ".join(reversed(phase.names))
        raise FaultError(f"phase {text!r}: the tree has no {way}; the outermost is written first")
    known = [name for node in reached(document, substitution.results) for name in names(node)]
    hint = valid_names(missing, known, "nodes")
    if phase.names[-1] == missing and len(phase.names) > 1:
        hint += "; what a skill notes while it runs stands behind the skill's name"
    raise FaultError(f"phase {text!r}: no node that runs is called {missing!r}; {hint}")


def wears(node: Node, name: str, document: Document) -> bool:
    """Whether a name, or a pattern, means the node; the main tree's name means its root."""
    own = names(node)
    if node is document.trees[document.main].root:
        own = [*own, document.main]
    return any(fnmatchcase(word, name) for word in own)


def _fits(phase: Phase, document: Document, substitution: Substitution) -> bool:
    if not phase.names:
        return True
    *outer, last = phase.names
    if any(wears(node, last, document) for node in _inside(outer, document, substitution)):
        return True
    if not outer or phase.after:
        return False
    # the last name may be a note of a running skill, which is in no file
    *outer, skill = outer
    return any(
        wears(node, skill, document)
        for node in _inside(outer, document, substitution)
        if _is_skill(node)
    )


def _named(name: str, document: Document, substitution: Substitution) -> bool:
    return any(wears(n, name, document) for n in reached(document, substitution.results))


def _is_skill(node: Node) -> bool:
    return node.type not in NODES and node.type != SUBTREE


def _inside(outer: list[str], document: Document, substitution: Substitution) -> Iterator[Node]:
    """Nodes that can run inside nodes with these names, the outermost first."""
    entered: set[tuple[str, int]] = {(document.main, 0)}
    stack: list[tuple[Node, int]] = [(document.trees[document.main].root, 0)]
    while stack:
        node, matched = stack.pop()
        if node.disabled:
            continue
        if matched == len(outer):
            yield node
        elif wears(node, outer[matched], document):
            matched += 1
        if substitution.replaces(node):
            continue
        target = node.target if node.type == SUBTREE else None
        if target is not None and (target, matched) not in entered:
            entered.add((target, matched))
            stack.append((document.trees[target].root, matched))
        below = [*node.children, *(h.node for h in node.handlers if h.node is not None)]
        stack.extend((child, matched) for child in reversed(below))
