"""YAML files that are deep, or have one long thing in them."""

from __future__ import annotations

import json
import random

from fuzzing.bomb import HEAD, LARGEST, Bomb


def _nested(size: int, r: random.Random) -> str:
    opening, closing = r.choice(
        [
            ("[", "]"),
            ("{a: ", "}"),
            ("{sequence: [", "]}"),
            ("{reactive_sequence: [wait: 1, ", "]}"),
            ("{parallel: [", "]}"),
            ("{invert: {child: ", "}}"),
            ("{repeat: {cycles: 2, child: ", "}}"),
            ("{recover: {attempts: 2, catch: {any: again}, try: ", "}}"),
            ("{handle: {try: {wait: 1}, catch: {any: ", "}}}"),
            ("{if: succeed, then: ", "}"),
        ]
    )
    size = min(size, r.choice([20, 40, 100, LARGEST]))
    return f"{HEAD}    {opening * size}wait: 1{closing * size}\n".replace("wait: 1}", "{wait: 1}}")


def _blocks(size: int, r: random.Random) -> str:
    size = min(size, 1000)
    return HEAD + "".join(f"{' ' * (4 + 2 * i)}- sequence:\n" for i in range(size))


def _dashes(size: int, r: random.Random) -> str:
    return HEAD + "    " + r.choice(["- ", "? ", "a: ", "&a ", "!a ", "# "]) * size


def _aliases(size: int, r: random.Random) -> str:
    width, levels = r.randint(2, 10), min(size, 200)
    lines = ["a0: &a0 [x, x]"]
    for level in range(1, levels):
        lines.append(f"a{level}: &a{level} [{', '.join([f'*a{level - 1}'] * width)}]")
    if r.random() < 0.3:
        lines = ["a: &a [*a, *b]", *(f"b: &b{i} *b{i - 1}" for i in range(size))]
    if r.random() < 0.3:
        lines = [f"a: &a [{', '.join(['1'] * size)}]", f"b: [{', '.join(['*a'] * 400)}]"]
    return "\n".join(["momantu_bt: 1", *lines, "trees: {Main: *a1}"]) + "\n"


def _long(size: int, r: random.Random) -> str:
    """One long thing: a line, a key, a number, a text, a comment, a name."""
    size *= r.choice([1, 9])
    things = ["x", "9", " ", "é", "日", "\\n", "$", "${a}", "$$", "a ", "'", '"', "\t", "-"]
    thing = (r.choice(things) * size)[:990_000]
    return r.choice(
        [
            f"{HEAD}    - say: {thing}\n",
            f'{HEAD}    - say: "{thing}"\n',
            f"{HEAD}    - say: '{thing}'\n",
            f"{HEAD}    - say: |\n        {thing}\n",
            f"{HEAD}    - {thing}: 1\n",
            f'{HEAD}    - ? "{thing}"\n      : 1\n',
            f"{HEAD}    - wait: {thing}\n",
            f"{HEAD}    - wait: 1{thing}\n      name: {thing}\n",
            f"# {thing}\n{HEAD}    - wait: 1\n",
            f"momantu_bt: {thing}\nmain: {thing}\n",
            f"{HEAD}    - wait: -0x{thing}\n",
            f"{HEAD}    - wait: 1e{thing}\n",
            f"{thing}",
            f"{HEAD}    - {{pick: {{object: $a{'.b' * (size // 9)}}}}}\n",
            f"{HEAD}    - {{say: &{thing} 1}}\n",
        ]
    )


def _scripts(size: int, r: random.Random) -> str:
    """One script that is deep or long, or many of them."""
    part = r.choice(
        [
            "(" * size + "1" + ")" * size,
            "(" * size,
            "not " * size + "$a",
            "!" * size + "a",
            "-" * size + "1",
            "1" + " + 1" * size,
            "$a" + " and $a" * size,
            "$a" + " ? 1 : $a" * size,
            "1" + " < 2" * size,
            "; ".join(f"$a{i} := {i}" for i in range(size)),
            "$a := " * size + "1",
            "'" + "x" * size,
            "'" * size,
            "9" * size,
            "1." * size,
            "1e" + "9" * size,
            "$a" + ".b" * size,
            "$" + "a" * size,
            "@" * size,
            "\u00e9" * size,
        ]
    )
    key = r.choice(["skip_if", "while", "on_success", "after"])
    return r.choice(
        [
            f"{HEAD}    - wait: 1\n      {key}: {json.dumps(part)}\n",
            f"{HEAD}    - script: {json.dumps(part)}\n",
            f"{HEAD}    - condition: {json.dumps(part)}\n",
            f"{HEAD}    - if: {json.dumps(part)}\n      then: wait\n",
        ]
    )


DEEP_BOMBS: tuple[Bomb, ...] = (
    _nested,
    _blocks,
    _dashes,
    _aliases,
    _long,
    _scripts,
)
