"""YAML files of which there is much: nodes, keys, codes, comments, calls, problems."""

from __future__ import annotations

import random

from fuzzing.bomb import HEAD, Bomb, word


def _wide(size: int, r: random.Random) -> str:
    kind = r.choice(["", "parallel", "fallback", "reactive_fallback", "round_robin", "unknown"])
    head = f"    {kind}:\n" if kind else ""
    item = r.choice(
        [
            "relocalize",
            "wait: 1 s",
            "navigate: {in_front_of: nowhere}",
            "{}",
            "Main",
            "{set: {key: $a{n}, value: 1}}",
            "{script: '$a{n} := 1'}",
            "{unset: $a{n}}",
            "{detect_object: {object: $a, on: $b{n}, found: $c{n}}}",
            "{wait: 1, name: n{n}}",
            "{wait: 1, name: same}",
            "{wait: 1, retry: 3, timeout: 1 s, skip_if: $a > 1}",
            "nonesuch{n}",
            "{nonesuch{n}: {a: 1}}",
            "{wait: {b{n}: 1}}",
            "{wait: 1, skp_if{n}: 1}",
            "{fail: code_{n}}",
            "{recover: {try: wait, catch: {A_{n}: again}}}",
        ]
    )
    return HEAD + head + "".join(f"      - {item.replace('{n}', str(i))}\n" for i in range(size))


def _keys(size: int, r: random.Random) -> str:
    """Many keys in one mapping: of the top, ports, values, handlers, modifiers, declarations."""
    same = r.random() < 0.3
    names = ["same" if same else f"k{i}" for i in range(size)]
    lines = ", ".join(f"{name}: 1" for name in names)
    codes = ", ".join(f"{name.upper()}: again" for name in names)
    return r.choice(
        [
            f"{HEAD}    {{wait: {{{lines}}}}}\n",
            f"{HEAD}    {{wait: 1, {lines}}}\n",
            f"momantu_bt: 1\nvalues: {{{lines}}}\ntrees: {{Main: [say: $k0]}}\n",
            f"momantu_bt: 1\ntrees: {{Main: {{wait: 1}}, {lines}}}\n",
            f"{HEAD}    {{recover: {{try: wait, catch: {{{codes}}}}}}}\n",
            f"{HEAD}    inputs: {{{lines.replace(': 1', ': text')}}}\n    wait: 1\n",
            f"{HEAD}    inputs: {{{lines}}}\n    wait: 1\n",
            f"{{{lines}}}\n",
            "".join(f"{name}: 1\n" for name in names),
        ]
    )


def _calls(size: int, r: random.Random) -> str:
    """Many trees that run each other: a long chain, one of many ways, a circle."""
    size = min(size, 5000)
    times, last = r.choice([1, 2, 5]), r.choice(["wait: 1", "T0", "pick: {object: $a}"])
    ports = r.choice(["", ": {a: $a}"])
    lines = [f"momantu_bt: 1\nmain: T0\ntrees:\n  T{size}: [{last}]"]
    for number in range(size):
        calls = ", ".join([f"{{T{number + 1}{ports or ': '}}}"] * times)
        declared = "inputs: {a: text}, " if ports else ""
        lines.append(f"  T{number}: {{{declared}{r.choice(['sequence', 'parallel'])}: [{calls}]}}")
    return "\n".join(lines) + "\n"


def _flows(size: int, r: random.Random) -> str:
    """Many keys known in many places: values, writes, reads, handlers and codes, side by side."""
    known, rest = size, r.choice([10, 500, 1500, 3000])
    values = ", ".join(f"v{i}: 1" for i in range(r.choice([0, min(known, 4000)])))
    node = r.choice(
        [
            "script: $k{n} := 1",
            f"script: {'; '.join(f'$k{{n}}_{i} := 1' for i in range(200))}",
            "{set: {key: $k{n}, value: 1}}",
            "{say: $k{n}}",
            "{wait: 1, skip_if: $k{n} > 1}",
            "{wait: 1, on_success: $k{n} := 1, while: $v{n} > 0}",
            "{fail: C{n}}",
            "Sub",
            "{Sub: , skip_if: $v1 > 1}",
            "{sequence: [Sub]}",
            "{timeout: {duration: 1, child: Sub}}",
            "{parallel: [relocalize, Sub]}",
            "{fallback: [{unset: $v{n}}, {reset_pose: $v{n}}]}",
        ]
    )
    calls = "".join(f"    - {node.replace('{n}', str(i))}\n" for i in range(rest))
    inside = r.choice(["fail: C{n}", "script: $s{n} := 1", "{set: {key: $s{n}, value: $v{n}}}"])
    below = "".join(f"    - {inside.replace('{n}', str(i))}\n" for i in range(min(known, 3000)))
    head = f"momantu_bt: 1\nmain: Main\nvalues: {{{values}}}\ntrees:\n"
    deep = r.choice(["", f"    - {'{reactive_sequence: [' * 30}"])
    bottom = f"[{', '.join(['{wait: 1}'] * min(size, 8000))}]{']}' * 30}\n" if deep else ""
    return f"{head}  Main:\n{calls}{deep}{bottom}  Sub:\n{below or '    - wait: 1'}\n"


def _comments(size: int, r: random.Random) -> str:
    item = r.choice(["    # c\n", "    - wait: 1 # c\n", "    - wait: 1\n      # c\n", "#\n"])
    return HEAD + "    - wait: 1\n" + item * size


def _texts(size: int, r: random.Random) -> str:
    """Many texts that are nearly a known word, nearly a unit, nearly a type."""
    known = r.choice(
        ["navigat", "sequenc", "reactive_sequenc", "retr", "timeou", "0.5 metr", "pos"]
    )
    lines = (f"    - {known}{word(r, 2)}: {{{known}: 1 {known}}}\n" for _ in range(size))
    return HEAD + "".join(lines)


def _alternatives(size: int, r: random.Random) -> str:
    codes = " | ".join(f"C{word(r, 3).upper()}" for _ in range(size))
    return (
        f"{HEAD}    recover:\n      try: wait\n      catch:\n        ? {codes}\n        : again\n"
    )


WIDE_BOMBS: tuple[Bomb, ...] = (
    _wide,
    _keys,
    _calls,
    _flows,
    _comments,
    _texts,
    _alternatives,
)
