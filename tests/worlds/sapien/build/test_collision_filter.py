"""Bits say exactly which links ignore each other."""

from __future__ import annotations

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.sapien.build.collision_filter import FLOOR_BIT, MOST_BITS, ignore_bits

LINKS = [f"link_{i}" for i in range(7)]
PAIRS = list(combinations(LINKS, 2))


@given(st.lists(st.sampled_from(PAIRS), max_size=21, unique=True))
def test_two_links_share_a_bit_exactly_when_they_are_a_pair(pairs: list[tuple[str, str]]) -> None:
    bits = ignore_bits([pair[::-1] if i % 2 else pair for i, pair in enumerate(pairs)])
    for first, second in PAIRS:
        shared = bits.get(first, 0) & bits.get(second, 0)
        assert (shared != 0) == ((first, second) in pairs)
        assert shared & FLOOR_BIT == 0


def test_many_links_that_all_ignore_each_other_need_one_bit() -> None:
    names = [f"n{i}" for i in range(60)]
    assert set(ignore_bits(combinations(names, 2)).values()) == {1}


def test_a_robot_with_more_groups_than_bits_ignores_a_few_more_pairs() -> None:
    apart = [(f"a{i}", f"b{i}") for i in range(MOST_BITS + 3)]
    exact = ignore_bits(apart[:MOST_BITS])
    assert len(exact) == 2 * MOST_BITS
    joined = ignore_bits(apart)
    assert max(joined.values()).bit_length() <= MOST_BITS
    assert all(joined[one] & joined[other] for one, other in apart)
    known = {frozenset(pair) for pair in apart}
    sharing = [p for p in combinations(joined, 2) if joined[p[0]] & joined[p[1]]]
    others = [pair for pair in sharing if frozenset(pair) not in known]
    assert len(others) == 3 * 4
