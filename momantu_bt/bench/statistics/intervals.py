"""Confidence intervals of a proportion, and of the difference of two paired proportions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

Interval: TypeAlias = tuple[float, float]

Z = 1.959963984540054
"""Two-sided 95 % quantile of the normal distribution."""


def wilson(successes: int, episodes: int) -> Interval:
    """95 % interval of a success rate: Wilson, J. Am. Stat. Assoc. 22 (1927) 209.

    All rates p with |successes/episodes - p| <= Z sqrt(p (1 - p) / episodes).
    Without episodes, 0 to 1.
    """
    if episodes == 0:
        return 0.0, 1.0
    rate, z2 = successes / episodes, Z**2 / episodes
    centre = (rate + z2 / 2) / (1 + z2)
    spread = Z * math.sqrt(rate * (1 - rate) / episodes + z2 / (4 * episodes)) / (1 + z2)
    low = 0.0 if successes == 0 else centre - spread
    high = 1.0 if successes == episodes else centre + spread
    return low, high


def mcnemar(only_a: int, only_b: int) -> float:
    """Two-sided exact p of paired outcomes: Mosteller, Biometrics 8 (1952) 220.

    If A and B are equally good, each pair that differs is a fair coin: twice the smaller tail of
    the binomial distribution, at most 1.
    """
    differing = only_a + only_b
    tail = sum(math.comb(differing, k) for k in range(min(only_a, only_b) + 1))
    share: float = 2 * tail / 2**differing
    return min(1.0, share)


def paired_difference(both: int, only_a: int, only_b: int, none: int) -> Interval:
    """95 % interval of rate A minus rate B over the same seeds.

    Newcombe, Statistics in Medicine 17 (1998) 2635, method 10: both rates' Wilson limits, joined
    by their correlation phi, whose numerator is corrected for continuity.
    """
    n = both + only_a + only_b + none
    if n == 0:
        return -1.0, 1.0
    a, b = both + only_a, both + only_b
    rate_a, rate_b = a / n, b / n
    (low_a, high_a), (low_b, high_b) = wilson(a, n), wilson(b, n)
    phi = _correlation(both, only_a, only_b, none)
    below = _joined(rate_a - low_a, high_b - rate_b, phi)
    above = _joined(high_a - rate_a, rate_b - low_b, phi)
    difference = rate_a - rate_b
    return max(-1.0, difference - below), min(1.0, difference + above)


def _correlation(both: int, only_a: int, only_b: int, none: int) -> float:
    n = both + only_a + only_b + none
    margins = (both + only_a) * (only_b + none) * (both + only_b) * (only_a + none)
    if margins == 0:
        return 0.0
    product = float(both * none - only_a * only_b)
    if product > 0:
        product = max(0.0, product - n / 2)
    return product / math.sqrt(margins)


def _joined(first: float, second: float, phi: float) -> float:
    return math.sqrt(max(0.0, first**2 - 2 * phi * first * second + second**2))


def quantile(values: Sequence[float], share: float) -> float:
    """The quantile of values at a share, linear between neighbours; NaN without values."""
    if not values:
        return math.nan
    ordered = sorted(values)
    at = share * (len(ordered) - 1)
    below = math.floor(at)
    above = min(below + 1, len(ordered) - 1)
    return ordered[below] + (ordered[above] - ordered[below]) * (at - below)
