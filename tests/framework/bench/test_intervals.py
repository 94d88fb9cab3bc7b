"""Intervals and p-values against their definitions and brute force."""

import itertools
import math
import random
import statistics

import pytest

from momantu_bt.bench.statistics.intervals import Z, mcnemar, paired_difference, quantile, wilson


@pytest.mark.parametrize("n", [1, 2, 7, 30, 500])
def test_wilson_is_where_the_score_test_just_does_not_reject(n: int) -> None:
    for k in range(0, n + 1, max(1, n // 17)):
        low, high = wilson(k, n)
        assert 0.0 <= low <= k / n <= high <= 1.0
        for p in (low, high):
            if 0.0 < p < 1.0:
                assert abs(k / n - p) / math.sqrt(p * (1 - p) / n) == pytest.approx(Z)


def test_wilson_of_mirrored_counts_is_mirrored_and_nothing_says_nothing() -> None:
    for k in range(31):
        low, high = wilson(k, 30)
        assert wilson(30 - k, 30) == (pytest.approx(1 - high), pytest.approx(1 - low))
    assert wilson(0, 0) == (0.0, 1.0)


def test_wilson_is_the_one_of_the_books() -> None:
    # Newcombe, Stat. Med. 17 (1998) 857, table I, method 3: 81 of 263, 15 of 148, 1 of 29
    assert wilson(81, 263) == (pytest.approx(0.2553, abs=5e-5), pytest.approx(0.3662, abs=5e-5))
    assert wilson(15, 148) == (pytest.approx(0.0624, abs=5e-5), pytest.approx(0.1605, abs=5e-5))
    assert wilson(1, 29) == (pytest.approx(0.0061, abs=5e-5), pytest.approx(0.1718, abs=5e-5))


@pytest.mark.parametrize("n", range(11))
def test_mcnemar_is_the_share_of_coin_rows_that_are_as_lopsided(n: int) -> None:
    """All 2^n ways in which the pairs that differ can have gone."""
    for heads in range(n + 1):
        lopsided = sum(
            abs(2 * sum(row) - n) >= abs(2 * heads - n)
            for row in itertools.product((0, 1), repeat=n)
        )
        assert mcnemar(heads, n - heads) == pytest.approx(min(1.0, lopsided / 2**n))


def test_mcnemar_of_many_pairs_neither_overflows_nor_depends_on_the_order() -> None:
    assert 0.0 <= mcnemar(3000, 2000) < 1e-40
    assert mcnemar(12, 5) == mcnemar(5, 12)


def test_the_paired_interval_holds_the_difference_and_turns_with_its_sides() -> None:
    draw = random.Random(1)
    for _ in range(300):
        a, b, c, d = (draw.randrange(20) for _ in range(4))
        n = a + b + c + d
        if n == 0:
            continue
        low, high = paired_difference(a, b, c, d)
        assert -1.0 <= low <= (b - c) / n <= high <= 1.0
        assert paired_difference(a, c, b, d) == (pytest.approx(-high), pytest.approx(-low))
    assert paired_difference(0, 0, 0, 0) == (-1.0, 1.0)


@pytest.mark.parametrize("cells", [(0.5, 0.2, 0.1, 0.2), (0.85, 0.1, 0.02, 0.03)])
def test_the_paired_interval_holds_the_truth_about_as_often_as_it_says(
    cells: tuple[float, ...],
) -> None:
    draw, held, n = random.Random(2), 0, 80
    for _ in range(1500):
        drawn = draw.choices(range(4), cells, k=n)
        low, high = paired_difference(*(drawn.count(cell) for cell in range(4)))
        held += low <= cells[1] - cells[2] <= high
    assert 0.93 <= held / 1500 <= 0.98


def test_quantiles_are_those_of_the_standard_library() -> None:
    draw = random.Random(3)
    values = [draw.gauss(0, 1) for _ in range(41)]
    theirs = statistics.quantiles(values, n=20, method="inclusive")
    assert [quantile(values, share / 20) for share in range(1, 20)] == pytest.approx(theirs)
    assert quantile([3.0], 0.95) == 3.0
    assert math.isnan(quantile([], 0.5))
