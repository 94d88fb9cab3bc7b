"""Pairs of links that ignore each other in collisions, as bits that SAPIEN compares."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from momantu_bt.world import WorldError

FLOOR_BIT = 1 << 30
"""Collision bit of the floor and of parts that may roll on it: shapes that share it ignore each
other."""
MOST_BITS = 30
"""Number of bits in a collision group besides FLOOR_BIT."""


def ignore_bits(pairs: Iterable[tuple[str, str]]) -> Mapping[str, int]:
    """Bits by link, so that two links share one exactly if their pair is among `pairs`.

    If all pairs of a group of links ignore each other, the group shares one bit; otherwise a robot
    with many pairs would need more bits than there are.

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
    """A group of links that contains a pair, and in which every two links are a pair."""
    group = list(pair)
    for link in dict.fromkeys(link for each in wanted for link in each):
        if link not in group and all((min(link, o), max(link, o)) in known for o in group):
            group.append(link)
    return group
