"""What a command line gives: a tree, also on standard input, and values; `--set` wins."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from momantu_bt.errors import InputError
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.formats.yaml.values import plain_value
from momantu_bt.tree.files.given_text import TreeText
from momantu_bt.tree.files.settings import Given
from momantu_bt.tree.files.syntax import compose
from momantu_bt.tree.files.text import read_text
from momantu_bt.tree.goals import OPTION
from momantu_bt.tree.load import read_values
from momantu_bt.tree.problems import TreeError

STDIN, SHOWN = Path("/dev/stdin"), "<stdin>"


def given_tree(tree: str) -> str | TreeText:
    """A tree argument: `-` is a text in YAML or XML on standard input.

    Raises:
        TreeNotFound, TreeError: standard input cannot be read, or is not text.
    """
    return TreeText(read_text(STDIN, SHOWN), SHOWN) if tree == "-" else tree


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


def given_goal(texts: Sequence[str] | None) -> Any:
    """What `--goal` gives, as plain values; None if it is not given. Several are one list.

    Raises:
        TreeNotFound, TreeError: a file cannot be read, or a goal is not YAML.
    """
    found = [_one_goal(text) for text in texts or ()]
    return found[0] if len(found) == 1 else found or None


def _one_goal(text: str) -> Any:
    file = OPTION
    if text.endswith((".yaml", ".yml")):
        file, text = text, read_text(Path(text), text)
    try:
        return plain_value(compose(text, file))
    except YamlSyntaxError as error:
        raise TreeError([error.problem], {file: text}) from None
