"""Pairs of links that ignore each other, as bits that SAPIEN compares."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from momantu_bt.world import WorldError

FLOOR_BIT = 1 << 30
"""Collision bit of what a base may roll on: shapes that share it ignore each other."""
MOST_BITS = 30
"""Bits of a group of shapes that are free beside FLOOR_BIT."""


def ignore_bits(pairs: Iterable[tuple[str, str]]) -> Mapping[str, int]:
    """Bits by link, so that two links share one exactly when their pair is among `pairs`.

    Links of which every two ignore each other share one bit, or a robot with many pairs would
    need more than there are.

    Raises:
        WorldError: more groups than bits.
    """
    wanted = list(dict.fromkeys((min(pair), max(pair)) for pair in pairs))
    known = set(wanted)
    bits: dict[str, int] = {}
    done: set[tuple[str, str]] = set()
    groups = 0
    for pair in wanted:
        if pair in done:
            continue
        group = _grown(pair, wanted, known)
        done |= {(a, b) for a in group for b in group if a < b}
        if groups == MOST_BITS:
            raise WorldError(
                f"`ignored_collisions` has {len(wanted)} pairs, which fall into more than "
                f"{MOST_BITS} groups of links that all ignore each other; leave out pairs of links "
                "that cannot reach each other anyway"
            )
        for link in group:
            bits[link] = bits.get(link, 0) | 1 << groups
        groups += 1
    return bits


def _grown(
    pair: tuple[str, str], wanted: list[tuple[str, str]], known: set[tuple[str, str]]
) -> list[str]:
    """A group of links that holds a pair, and in which every two are a pair."""
    group = list(pair)
    for link in dict.fromkeys(link for each in wanted for link in each):
        if link not in group and all((min(link, o), max(link, o)) in known for o in group):
            group.append(link)
    return group
