"""Read the values of `--values` and `--set`; `--set` wins."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from momantu_bt.errors import InputError
from momantu_bt.tree.files.settings import Given
from momantu_bt.tree.load import read_values


def given_values(settings: Sequence[str], file: Path | None) -> Given:
    """Values of the root's board.

    Raises:
        InputError: a setting is not written as key=value.
        TreeNotFound, TreeError: the file cannot be read, or is not a mapping.
    """
    board = Given() if file is None else read_values(file)
    try:
        board.set(settings)
    except ValueError as error:
        raise InputError(str(error)) from None
    return board
