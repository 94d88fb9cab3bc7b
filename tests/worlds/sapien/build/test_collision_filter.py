"""Bits say exactly which links ignore each other."""

from __future__ import annotations

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.sapien.build.collision_filter import FLOOR_BIT, MOST_BITS, ignore_bits

from momantu_bt.world import WorldError

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


def test_too_many_groups_are_refused() -> None:
    apart = [(f"a{i}", f"b{i}") for i in range(MOST_BITS + 1)]
    assert len(ignore_bits(apart[:-1])) == 2 * MOST_BITS
    with pytest.raises(WorldError, match="31 pairs"):
        ignore_bits(apart)
