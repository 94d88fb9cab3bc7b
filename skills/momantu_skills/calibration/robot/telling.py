"""Which parameters the views cannot tell apart, in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from momantu_bt.geometry import Array

_WEAK = 3.0
"""Information below which a direction's deviation stays above half of what is usual."""
_PART = 0.2
"""A parameter belongs to a direction if it has this share of its largest one."""


def untold(information: Array, usual: Array, names: Sequence[str]) -> list[tuple[str, ...]]:
    """Groups of parameters of which the views tell only a combination; alone: not told at all.

    information: (P, P) of the views; usual: (P,), standard deviations without views.
    """
    scaled = information * np.outer(usual, usual)
    values, vectors = np.linalg.eigh(scaled)
    weak = vectors[:, values < _WEAK].T
    groups = []
    for direction in _sparse(weak):
        parts = np.abs(direction) >= _PART * np.abs(direction).max()
        groups.append(tuple(names[int(i)] for i in np.flatnonzero(parts)))
    return sorted(set(groups), key=lambda group: (len(group), names.index(group[0])))


def _sparse(basis: Array) -> Array:
    """The same space (k, P), each row with a parameter that no other row has (Gauss and Jordan)."""
    rows = basis.copy()
    for k in range(len(rows)):
        rest = np.abs(rows[k:])
        at, pivot = divmod(int(rest.argmax()), rest.shape[1])
        rows[[k, k + at]] = rows[[k + at, k]]
        rows[k] /= rows[k, pivot]
        others = np.arange(len(rows)) != k
        rows[others] -= np.outer(rows[others, pivot], rows[k])
    return rows
