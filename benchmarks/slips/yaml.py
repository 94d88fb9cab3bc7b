"""Slips that people make in YAML trees, each at every place of a line where it can be made."""

from __future__ import annotations

import re

from momantu_bt.tree.catalogue import MODIFIERS
from slips.xml import Slip, each, lost, swapped

KEYBOARD = ("qwertyuiop", "asdfghjkl", "zxcvbnm")


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
