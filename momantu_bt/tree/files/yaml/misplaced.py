"""Lines of a tree file that stand too far left or right: told once, and read where they belong.

Without this, one wrong indentation would be an error at every place that uses what is lost.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

from momantu_bt.formats.names import nearest
from momantu_bt.formats.yaml.values import Entries, Raw, Scalar
from momantu_bt.tree.catalogue import MODIFIERS, SPELLED
from momantu_bt.tree.files.yaml.words import COMPANIONS, HEADER, NAMED, PORTS
from momantu_bt.tree.language import TREE_NAME, is_handler
from momantu_bt.tree.problems import Problems

_BESIDE = {name for names in COMPANIONS.values() for name in names}
_BRANCHES = ("try", "catch")
_HOLDERS = ("values", "trees")
Entry = tuple[Scalar, Raw]


def indent_top(raw: Entries, top: Collection[str], problems: Problems) -> frozenset[str]:
    """Put trees and values that begin in the first column under `trees:` and `values:`.

    top: the keys of a tree file. Returns the names that were moved.
    """
    kept: list[Entry] = []
    moved: dict[str, None] = {}
    inside = False
    for key, value in raw.entries:
        holder = kept[-1] if kept else None
        if key.text in top or holder is None or not _may_hold(holder, key, value, top):
            kept.append((key, value))
            inside = False
            continue
        name = holder[0].text
        if not inside:
            message = f"a tree file has no {key.text!r}"
            hint = f"if it is one of the {name}, indent it and what belongs to it, under `{name}:`"
            problems.error("unknown-key", key.place, message, hint)
        inside = True
        kept[-1] = (holder[0], _with(holder[1], (key, value)))
        moved[key.text] = None
    raw.entries = kept
    return frozenset(moved)


def _may_hold(holder: Entry, key: Scalar, value: Raw, top: Collection[str]) -> bool:
    name, held = holder[0].text, holder[1]
    if name not in _HOLDERS or nearest(key.text, top) is not None or not _is_open(held):
        return False
    return name == "values" or _is_empty(value) or not isinstance(value, Scalar)


@dataclass(frozen=True, slots=True)
class Trees:
    """Puts the lines of trees where they belong. skills: their names. moved: trees already told."""

    skills: Collection[str]
    moved: frozenset[str]
    problems: Problems

    def settle(self, raw: Raw) -> None:
        """Mend the mapping under `trees:` in place."""
        if not isinstance(raw, Entries):
            return
        waiting, found = self._indented(raw.entries), []
        names = {key.text for key, _ in waiting}
        while waiting:
            key, body = waiting.pop(0)
            pushed_in: list[Entry] = []
            if isinstance(body, Entries) and not body.flow and len(body.entries) > 1:
                body, pushed_in = self._split(key, body, names)
            found.append((key, body))
            names |= {each.text for each, _ in pushed_in}
            waiting = pushed_in + waiting
        raw.entries = found

    def _indented(self, entries: list[Entry]) -> list[Entry]:
        """Trees with the parts that stand beside their name."""
        found: list[Entry] = []
        told = ""
        for key, value in entries:
            tree = found[-1] if found else None
            if tree is None or not self._lacks(tree[1], key.text):
                found.append((key, value))
                continue
            name = tree[0].text
            if told != name:
                message = f"{key.text!r} stands beside the tree {name!r}"
                hint = f"indent it and the lines that belong to it, under `{name}:`"
                self.problems.error("indentation", key.place, message, hint)
            told = name
            found[-1] = (tree[0], _with(tree[1], (key, value)))
        return found

    def _lacks(self, body: Raw, name: str) -> bool:
        """Whether a tree has no such part yet, and may have one."""
        if not self._is_part(name) or not _is_open(body):
            return False
        having = {key.text for key, _ in body.entries} if isinstance(body, Entries) else set()
        if name in having:
            return False
        if name in HEADER or name in MODIFIERS or name in _BESIDE:
            return True
        return "nodes" not in having and having <= {*HEADER, *MODIFIERS}

    def _is_part(self, name: str) -> bool:
        """Whether it is a part of a tree and no name of one."""
        if name in HEADER or name in MODIFIERS or name in _BESIDE:
            return True
        return self._is_node(name)

    def _is_node(self, name: str) -> bool:
        return name in SPELLED or name in COMPANIONS or name in NAMED or name in self.skills

    def _split(self, tree: Scalar, body: Entries, names: set[str]) -> tuple[Entries, list[Entry]]:
        """A tree's own entries, and the trees that stand among them."""
        own: list[Entry] = []
        for at, (key, value) in enumerate(body.entries):
            begun = any(self._is_node(each.text) for each, _ in own)
            if not begun or key.text in names or not self._is_tree_name(key):
                own.append((key, value))
                continue
            rest = body.entries[at + 1 :]
            if _is_empty(value) and rest and self._is_part(rest[0][0].text):
                self._tell(key, tree)
                return Entries(own, body.place), [(key, Entries(rest, value.place))]
            if self._is_body(value):
                self._tell(key, tree)
                after, others = self._split(tree, Entries([*own, *rest], body.place), names)
                return after, [(key, value), *others]
            own.append((key, value))
        return body, []

    def _is_tree_name(self, key: Scalar) -> bool:
        part = self._is_part(key.text) or key.text in _BRANCHES
        return not part and TREE_NAME.fullmatch(key.text) is not None

    def _is_body(self, value: Raw) -> bool:
        return isinstance(value, Entries) and any(k.text in PORTS for k, _ in value.entries)

    def _tell(self, key: Scalar, tree: Scalar) -> None:
        if tree.text in self.moved:
            return
        message = f"the tree {key.text!r} stands inside the tree {tree.text!r}"
        hint = f"move `{key.text}:` left, to the column of `{tree.text}:`"
        self.problems.error("indentation", key.place, message, hint)


def indent_branches(
    key: Scalar, value: Raw, beside: list[Entry], ports: Collection[str], problems: Problems
) -> tuple[Raw, list[Entry]]:
    """A node with `try:` and `catch:`, with those of its parts that stand beside its key.

    Returns its value, and what is truly beside it.
    """
    having = {k.text for k, _ in value.entries} if isinstance(value, Entries) else set()
    if not _is_open(value):
        return value, beside
    own = {*_BRANCHES, *ports} - having
    found = [entry for entry in beside if entry[0].text in own and entry[0].text not in MODIFIERS]
    if not found:
        return value, beside
    _tell_beside(found[0][0], key.text, problems)
    for entry in found:
        value = _with(value, entry)
    return value, [entry for entry in beside if entry not in found]


def settle_branches(value: Entries, ports: Collection[str], problems: Problems) -> None:
    """Put `try:`, `catch:` and what belongs below them in place, in the value of their node."""
    _fill(
        value, lambda name: name in _BRANCHES, lambda name: name in (*_BRANCHES, *ports), problems
    )
    having = {key.text: inner for key, inner in value.entries}
    inner = having.get("try")
    if "catch" in having or not isinstance(inner, Entries) or inner.flow:
        return
    at = next((n for n, (key, _) in enumerate(inner.entries) if key.text == "catch"), None)
    if not at:
        return
    key, below = inner.entries[at]
    rest = inner.entries[at + 1 :]
    if _is_empty(below):
        below, rest = Entries(rest, below.place), []
    message, hint = "`catch:` stands inside `try:`", "move `catch:` left, to the column of `try:`"
    problems.error("indentation", key.place, message, hint)
    inner.entries = [*inner.entries[:at], *rest]
    value.entries.append((key, below))


def settle_handlers(raw: Entries, problems: Problems) -> None:
    """Put nodes that stand beside their codes under them."""
    _fill(raw, is_handler, is_handler, problems)


def _fill(
    raw: Entries, may: Callable[[str], bool], own: Callable[[str], bool], problems: Problems
) -> None:
    """Give each empty key that may have something below it what follows and does not belong here.

    own: whether a key belongs here.
    """
    if raw.flow or not any(_is_empty(value) for _, value in raw.entries):
        return
    found: list[Entry] = []
    opened = False
    for key, value in raw.entries:
        if opened and not own(key.text):
            if _is_empty(found[-1][1]):
                _tell_beside(key, found[-1][0].text, problems)
            found[-1] = (found[-1][0], _with(found[-1][1], (key, value)))
            continue
        found.append((key, value))
        opened = may(key.text) and _is_empty(value)
    raw.entries = found


def _tell_beside(key: Scalar, name: str, problems: Problems) -> None:
    message = f"{key.text!r} stands beside `{name}:`"
    hint = f"indent it and the lines that belong to it, under `{name}:`"
    problems.error("indentation", key.place, message, hint)


def _is_empty(raw: Raw) -> bool:
    return isinstance(raw, Scalar) and raw.value is None and not raw.text


def _is_open(raw: Raw) -> bool:
    """Whether more lines could follow in it."""
    return _is_empty(raw) or (isinstance(raw, Entries) and not raw.flow)


def _with(raw: Raw, entry: Entry) -> Entries:
    having = raw.entries if isinstance(raw, Entries) else []
    return Entries([*having, entry], raw.place)


__all__ = ["Trees", "indent_branches", "indent_top", "settle_branches", "settle_handlers"]
