"""Seeds as people write them."""

import random

import pytest

from momantu_bt.formats.seeds import SeedsError, parse_seeds, seeds_text


@pytest.mark.parametrize(
    ("text", "seeds"),
    [
        ("0:3", (0, 1, 2)),
        ("3,5,7", (3, 5, 7)),
        ("0:2,20:22, 4", (0, 1, 20, 21, 4)),
        ("1,1,0:3", (1, 0, 2)),
    ],
)
def test_the_forms(text: str, seeds: tuple[int, ...]) -> None:
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize("text", ["", "a", "1-3", "3:", ":3", "-1:3", "5:5", "5:3", "1,,2", "1.5"])
def test_what_is_none_is_told_what_would_be(text: str) -> None:
    with pytest.raises(SeedsError, match="0:500"):
        parse_seeds(text)


def test_too_many() -> None:
    with pytest.raises(SeedsError, match="more than"):
        parse_seeds("0:1000000000")


def test_seeds_are_told_as_ranges() -> None:
    assert seeds_text([47, 12, *range(40, 47)]) == "12, 40-47"
    assert seeds_text([1, 2]) == "1, 2"
    assert seeds_text([]) == ""


def test_what_is_told_means_the_same_seeds() -> None:
    draw = random.Random(0)
    for _ in range(200):
        seeds = {draw.randrange(30) for _ in range(draw.randrange(20))}
        told = [part.strip() for part in seeds_text(seeds).split(",") if part]
        found = set()
        for part in told:
            first, _, last = part.partition("-")
            found |= set(range(int(first), int(last or first) + 1))
        assert found == seeds
