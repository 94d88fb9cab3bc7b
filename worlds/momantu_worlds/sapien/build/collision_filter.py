"""Pairs of links that ignore each other in collisions, as bits that SAPIEN compares."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

FLOOR_BIT = 1 << 30
"""Collision bit of the floor and of parts that may roll on it: shapes that share it ignore each
other."""
MOST_BITS = 30
"""Number of bits in a collision group besides FLOOR_BIT."""


def ignore_bits(pairs: Iterable[tuple[str, str]]) -> Mapping[str, int]:
    """Bits by link, so that two links share one if their pair is among `pairs`.

    If all pairs of a group of links ignore each other, the group shares one bit; otherwise a robot
    with many pairs would need more bits than there are. Of a robot that still needs more, those
    groups are joined that ignore the fewest other pairs together: two links of one robot that pass
    through each other do less harm than two that push each other apart for good.
    """
    wanted = list(dict.fromkeys((min(pair), max(pair)) for pair in pairs))
    known = set(wanted)
    done: set[tuple[str, str]] = set()
    groups: list[frozenset[str]] = []
    for pair in wanted:
        if pair in done:
            continue
        group = _grown(pair, wanted, known)
        done |= {(a, b) for a in group for b in group if a < b}
        groups.append(frozenset(group))
    bits: dict[str, int] = {}
    for number, links in enumerate(_joined(groups, known)):
        for link in links:
            bits[link] = bits.get(link, 0) | 1 << number
    return bits


def _joined(groups: list[frozenset[str]], known: set[tuple[str, str]]) -> list[frozenset[str]]:
    """At most MOST_BITS groups, the cheapest ones joined."""

    def added(links: frozenset[str]) -> int:
        return sum((a, b) not in known for a in links for b in links if a < b)

    while len(groups) > MOST_BITS:
        costs = [
            (added(one | other), i, k)
            for i, one in enumerate(groups)
            for k, other in enumerate(groups[:i])
        ]
        _, i, k = min(costs)
        groups = [g for n, g in enumerate(groups) if n not in (i, k)] + [groups[i] | groups[k]]
    return groups


def _grown(
    pair: tuple[str, str], wanted: list[tuple[str, str]], known: set[tuple[str, str]]
) -> list[str]:
    """A group of links that contains a pair, and in which every two links are a pair."""
    group = list(pair)
    for link in dict.fromkeys(link for each in wanted for link in each):
        if link not in group and all((min(link, o), max(link, o)) in known for o in group):
            group.append(link)
    return group
