"""Misspelled words of the language: told once, and read as the words that they are near to.

Without this, one wrong letter in `catch:` would be an error at every line below it.
"""

from __future__ import annotations

from collections.abc import Collection

from momantu_bt.formats.names import nearest
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.catalogue import MODIFIERS, SPELLED, Kind, NodeSpec
from momantu_bt.tree.catalogue.synonyms import in_spelling, meant_type
from momantu_bt.tree.files.yaml.words import COMPANIONS, PORTS
from momantu_bt.tree.language import is_handler
from momantu_bt.tree.problems import Problems

_LIKE = 0.75
"""A word counts as misspelled from this likeness on."""
_LIKE_SHORT = 0.5
"""The same for words of two letters, whose place tells what they are."""


def mend_words(
    raw: Entries,
    words: Collection[str],
    where: str,
    problems: Problems,
    holding: Collection[str] = (),
) -> None:
    """Read each key that is near to a word which the mapping lacks as that word.

    words: all keys that have a meaning here. where: what the keys belong to, for the message.
    holding: those of the words that hold nodes. If one of them is lacking, the only unknown key
    that holds more than a value is taken for it.
    """
    having = {key.text for key, _ in raw.entries}
    lacking = [word for word in words if word not in having]
    holders = [key.text for key, value in raw.entries if _holds(key, value, words)]
    free = [word for word in holding if word in lacking]
    for at, (key, value) in enumerate(raw.entries):
        near = None if key.text in words else nearest(key.text, lacking, least=_LIKE)
        if near is None and holders == [key.text] and len(free) == 1:
            near = free[0]
        if near is None:
            continue
        message = f"{where} has no `{key.text}:`"
        problems.error("unknown-key", key.place, message, f"did you mean {near}?")
        raw.entries[at] = (_as(key, near), value)
        lacking.remove(near)


def _holds(key: Scalar, value: Raw, words: Collection[str]) -> bool:
    """Whether a key that has no meaning here holds more than one value, as no condition does."""
    known = key.text in words or key.text in SPELLED
    return not known and not isinstance(value, Scalar) and not is_handler(key.text)


def mend_declarations(raw: Entries, skills: Collection[str], problems: Problems) -> None:
    """Read `inptus: {name: type}` beside the nodes of a tree as `inputs:`."""
    found = Entries(
        [(k, v) for k, v in raw.entries if k.text in PORTS or _declares(k.text, v, skills)],
        raw.place,
    )
    before = [key for key, _ in found.entries]
    mend_words(found, PORTS, "a tree", problems)
    mended = {id(old): new for old, (new, _) in zip(before, found.entries, strict=True)}
    raw.entries = [(mended.get(id(key), key), value) for key, value in raw.entries]


def _declares(name: str, value: Raw, skills: Collection[str]) -> bool:
    """Whether an unknown key has the form of declared inputs or outputs."""
    if name in SPELLED or name in skills:
        return False
    if isinstance(value, Items):
        return all(isinstance(item, Scalar) for item in value.items)
    return isinstance(value, Entries) and all(
        (isinstance(each, Scalar) and isinstance(each.value, str) and "$" not in each.text)
        or (isinstance(each, Entries) and any(key.text == "type" for key, _ in each.entries))
        for _, each in value.entries
    )


def mend_companions(key: Scalar, raw: Entries, problems: Problems) -> None:
    """Read `thne:` beside `if:` as `then:`. key: the node's key, such as `if`."""
    words = COMPANIONS[key.text]
    beside = Entries([e for e in raw.entries if _is_companion(e[0], key, words)], raw.place)
    mend_words(beside, words, f"`{key.text}`", problems)
    mended = {id(value): new for new, value in beside.entries}
    raw.entries = [(mended.get(id(value), key), value) for key, value in raw.entries]


def mend_branching(raw: Entries, problems: Problems) -> None:
    """Read `fi: …` with `then:` beside it as `if:`, and the same for the other such nodes."""
    having = {key.text for key, _ in raw.entries}
    if not having.isdisjoint(COMPANIONS):
        return
    for at, (key, value) in enumerate(raw.entries):
        near = None if key.text in SPELLED else nearest(key.text, COMPANIONS, least=_LIKE_SHORT)
        if near is not None and not having.isdisjoint({*COMPANIONS[near]} - {"else"}):
            message = f"no node is called {key.text!r}"
            problems.error("unknown-node", key.place, message, f"did you mean {near}?")
            raw.entries[at] = (_as(key, near), value)
            return


def _is_companion(key: Scalar, node: Scalar, words: Collection[str]) -> bool:
    """Whether a key beside the node's is one of the words, or unknown."""
    known = key.text in SPELLED or key.text in MODIFIERS
    return key is not node and (key.text in words or not known)


def meant_word(name: str, value: Raw) -> str | None:
    """The node with nodes below it that an unknown name means, by what stands below; else None."""
    if isinstance(value, Items):
        return _near(name, [word for word, spec in SPELLED.items() if spec.kind is Kind.CONTROL])
    if isinstance(value, Entries):
        return meant_above(name, {key.text for key, _ in value.entries})
    return None


def meant_above(name: str, having: Collection[str]) -> str | None:
    """The same, for a mapping with these keys."""
    return _near(name, [word for word, spec in SPELLED.items() if _fits(having, spec)])


def _near(name: str, able: Collection[str]) -> str | None:
    meant = meant_type(name)
    other = None if meant is None else in_spelling(meant, xml=False)
    return other if other in able else nearest(name, able)


def _fits(having: Collection[str], spec: NodeSpec) -> bool:
    """Whether some of the keys hold nodes of this node."""
    if spec.handlers:
        return "try" in having or "catch" in having
    kind = spec.kind
    return (kind is Kind.DECORATOR and "child" in having) or (
        kind is Kind.CONTROL and "children" in having
    )


def _as(key: Scalar, word: str) -> Scalar:
    return Scalar(word, word, key.quoted, key.place)
