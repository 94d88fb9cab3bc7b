"""Well-formed YAML of the language's own words, in all the wrong places."""

from __future__ import annotations

import json
import random
import re

from fuzzing.words import Words
from momantu_bt.tree.catalogue import MODIFIERS, SPELLED


def yaml_file(r: random.Random, words: Words) -> str:
    """A tree file with a header, a main tree and perhaps another one."""
    head = "momantu_bt: 1\nmain: Main\n"
    if r.random() < 0.5:
        head += "world: four_rooms\n"
    if r.random() < 0.3:
        head += f"values: {_value(r, words, 3)}\n"
    text = f"{head}trees:\n  Main: {_node(r, words, r.randint(1, 5))}\n"
    if r.random() < 0.5:
        ports = f"inputs: {_value(r, words, 2)}, outputs: {{a: pose}}, sequence: "
        text += f"  Sub: {{{ports}{_node(r, words, 2)}}}\n"
    return text


def _node(r: random.Random, words: Words, depth: int) -> str:
    if depth == 0 or r.random() < 0.1:
        return _value(r, words, 1)
    if r.random() < 0.2:
        return f"[{', '.join(_node(r, words, depth - 1) for _ in range(r.randint(0, 4)))}]"
    name = r.choice(words.nodes)
    entries = [f"{name}: {_below(r, words, name, depth)}"]
    for _ in range(r.choice([0, 0, 1, 2])):
        entries.append(f"{r.choice([*MODIFIERS, *words.all])}: {_value(r, words, 1)}")
    if name in ("if", "while_do", "switch"):
        for word in r.sample(["then", "do", "else", "cases", "default"], 3):
            entries.append(f"{word}: {_node(r, words, depth - 1)}")
    return "{" + ", ".join(entries) + "}"


def _below(r: random.Random, words: Words, name: str, depth: int) -> str:
    """What stands behind a node's name; mostly of the form that the node has."""
    spec = SPELLED.get(name)
    ports = {port: _value(r, words, 2) for port in (spec.ports if spec else ("at", "object"))}
    if r.random() < 0.2:
        return _node(r, words, depth - 1)
    children = f"[{', '.join(_node(r, words, depth - 1) for _ in range(r.randint(0, 3)))}]"
    if spec is not None and spec.handlers:
        codes = r.choice(["any", "A_CODE | TIMEOUT", "pick.SLIPPED", "a"])
        handler = r.choice(["again", _node(r, words, depth - 1)])
        ports |= {"try": _node(r, words, depth - 1), "catch": f"{{{codes}: {handler}}}"}
    elif spec is not None and spec.children[1] == 1:
        ports["child"] = _node(r, words, depth - 1)
    elif spec is not None and spec.children[1] != 0:
        ports["children"] = children
    return "{" + ", ".join(f"{key}: {value}" for key, value in ports.items()) + "}"


def _value(r: random.Random, words: Words, depth: int) -> str:
    if depth == 0 or r.random() < 0.6:
        word = r.choice(words.all)
        plain = re.fullmatch(r"[\w.$@][\w.$@ /-]*", word) or word.startswith('"')
        return word if plain else json.dumps(word)
    inner = [_value(r, words, depth - 1) for _ in range(r.randint(0, 3))]
    if r.random() < 0.5:
        return f"[{', '.join(inner)}]"
    return "{" + ", ".join(f"{r.choice(words.plain)!s}: {each}" for each in inner) + "}"
