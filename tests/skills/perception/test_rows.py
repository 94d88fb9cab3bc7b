"""Different rows are found as `np.unique` finds them."""

from __future__ import annotations

import numpy as np
import pytest
from momantu_skills.perception.geometry.rows import unique_rows


@pytest.mark.parametrize("scale", [1, 10**6, 2**40])
@pytest.mark.parametrize("columns", [1, 2, 3])
def test_rows_and_counts_are_those_of_numpy(scale: int, columns: int) -> None:
    random = np.random.default_rng(scale + columns)
    rows = random.integers(-4, 5, (300, columns)) * scale
    found, counts = unique_rows(rows)
    expected, times = np.unique(rows, axis=0, return_counts=True)
    assert np.array_equal(found, expected)
    assert np.array_equal(counts, times)
    assert found.dtype == rows.dtype


def test_no_rows_have_no_different_ones() -> None:
    found, counts = unique_rows(np.empty((0, 3), dtype=np.int64))
    assert found.shape == (0, 3)
    assert counts.shape == (0,)
