"""Inputs that no tree file should be, each made from the seed and its number alone.

Four kinds: bytes (any at all, damaged good files, other encodings), tokens (words and lines of good
files, removed, doubled and moved), nodes (well-formed, of the language's own words, in all the
wrong places) and bombs (small things that want to become large).
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from fuzzing.bomb import LARGEST, Bomb
from fuzzing.deep_bombs import DEEP_BOMBS
from fuzzing.wide_bombs import WIDE_BOMBS
from fuzzing.words import Words
from fuzzing.xml_bombs import XML_BOMBS
from fuzzing.xml_files import xml_file
from fuzzing.yaml_files import yaml_file

_SHARES = {"bytes": 20, "tokens": 45, "nodes": 32, "bomb": 3}
_ENCODINGS = ("utf-16", "utf-16-le", "utf-32", "utf-8-sig", "cp037", "utf-7")
_SMUGGLED = (b"\0", b"\x1b[2J", b"\r", b"\x85", b"\xe2\x80\xa8", b"\t")
_BOMBS: Mapping[str, Sequence[Bomb]] = {".yaml": (*DEEP_BOMBS, *WIDE_BOMBS), ".xml": XML_BOMBS}
_FILES: Mapping[str, Callable[[random.Random, Words], str]] = {".yaml": yaml_file, ".xml": xml_file}


@dataclass(frozen=True)
class Input:
    """One input. kind: how it was made. suffix: that of its file."""

    kind: str
    suffix: str
    data: bytes


class Inputs:
    """All inputs of a seed. good: the texts of good trees, by the suffix of their files."""

    def __init__(self, seed: int, good: Mapping[str, Sequence[str]], words: Words) -> None:
        self.seed = seed
        self.good = good
        self.words = words

    def make(self, number: int) -> Input:
        """The input of that number."""
        r = random.Random(f"{self.seed}:{number}")
        suffix = r.choice(sorted(self.good))
        kind = r.choices(list(_SHARES), list(_SHARES.values()))[0]
        if kind == "bytes":
            return Input(kind, suffix, self.some_bytes(r, suffix))
        if kind == "tokens":
            text = self.some_tokens(r, suffix)
        elif kind == "nodes":
            text = _FILES[suffix](r, self.words)
        else:
            text = r.choice(_BOMBS[suffix])(int(LARGEST ** r.uniform(0.2, 1)), r)
        return Input(kind, suffix, text.encode("utf-8", "surrogatepass"))

    def some_bytes(self, r: random.Random, suffix: str) -> bytes:
        """Any bytes, a good file with some of its bytes changed, or in another encoding."""
        way = r.randrange(4)
        if way == 0:
            return r.randbytes(r.randrange(200))
        good = r.choice(self.good[suffix])
        if way == 1:
            encoding = r.choice(_ENCODINGS)
            return good.encode(encoding, "replace")
        data = bytearray(good.encode())
        for _ in range(r.randint(1, 8)):
            at = r.randrange(len(data))
            way = r.randrange(4)
            if way == 0:
                data[at] = r.randrange(256)
            elif way == 1:
                del data[at : at + r.randint(1, 40)]
            elif way == 2:
                data[at:at] = r.randbytes(r.randint(1, 4))
            else:
                data[at:at] = r.choice(_SMUGGLED)
            if not data:
                break
        return bytes(data)

    def some_tokens(self, r: random.Random, suffix: str) -> str:
        """A good file with words and lines removed, doubled, swapped, moved or exchanged."""
        good = r.choice(self.good[suffix])
        whole_lines = r.random() < 0.4
        parts = good.splitlines(keepends=True) if whole_lines else re.findall(r"\w+|\s+|.", good)
        for _ in range(r.choice([1, 1, 2, 3, 10])):
            at, other = r.randrange(len(parts)), r.randrange(len(parts))
            way = r.randrange(6)
            if way == 0 and len(parts) > 2:
                del parts[at]
            elif way == 1:
                parts.insert(other, parts[at])
            elif way == 2:
                parts[at], parts[other] = parts[other], parts[at]
            elif way == 3:
                parts[at] = r.choice(["", "  ", "    ", "\n"]) + parts[at]
            elif way == 4:
                parts[at] = r.choice(self.words.all) + ("\n" if whole_lines else "")
            else:
                parts[at : at + 4] = r.sample(parts[at : at + 4], len(parts[at : at + 4]))
        return "".join(parts)
