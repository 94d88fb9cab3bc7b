"""The different rows of a table of whole numbers."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.int64]


def unique_rows(rows: Rows) -> tuple[Rows, NDArray[np.int64]]:
    """The different rows (m, k) of (n, k), in their order, and how often each occurs (m,).

    The result is that of `np.unique` with `axis=0`, which compares whole rows and is slow: here
    each row becomes one number with the same order.
    """
    if not len(rows):
        return rows, np.empty(0, dtype=np.int64)
    low = rows.min(axis=0)
    spans = [int(span) for span in rows.max(axis=0) - low + 1]
    if math.prod(spans) >= np.iinfo(np.int64).max:
        found, counts = np.unique(rows, axis=0, return_counts=True)
        return found, counts
    numbers = np.zeros(len(rows), dtype=np.int64)
    for column, (least, span) in enumerate(zip(low, spans, strict=True)):
        numbers *= span
        numbers += rows[:, column] - least
    numbers, counts = np.unique(numbers, return_counts=True)
    return np.stack(np.unravel_index(numbers, spans), axis=1) + low, counts
