"""Poses over time from a text file: CSV, or the TUM format with blanks between the columns."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from momantu_bt.errors import InputError
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem, show
from momantu_bt.formats.text import TextError, read_text
from momantu_skills.calibration.trajectory.trajectory import Trajectory

COLUMNS = ("t", "x", "y", "z", "qx", "qy", "qz", "qw")
"""The order of columns in a file without a header."""
_MOST_BYTES = 200_000_000
_NORMALISED = 0.05
"""A quaternion whose length is off by less is normalised."""
_SAME_PLACE = 0.01
_SAME_TURN = math.radians(2.0)
"""m and rad: samples of one stamp that are this near are one sample."""
_SPELLINGS = {
    "t": "t time timestamp stamp seconds sec timestamps times",
    "x": "x tx px positionx posx translationx",
    "y": "y ty py positiony posy translationy",
    "z": "z tz pz positionz posz translationz",
    "qx": "qx orientationx rotationx quaternionx quatx",
    "qy": "qy orientationy rotationy quaterniony quaty",
    "qz": "qz orientationz rotationz quaternionz quatz",
    "qw": "qw orientationw rotationw quaternionw quatw",
}
_EULER = frozenset({"roll", "pitch", "yaw", "rx", "ry", "rz", "rpy", "alpha", "beta", "gamma"})
_COLUMN = {word: name for name, words in _SPELLINGS.items() for word in words.split()}
_BLANK = " \t\r\"'"
_UNITS = re.compile(r"[\[(].*?[\])]")


class TrajectoryError(InputError):
    """A file of poses is wrong; the message has the line with a caret."""


@dataclass(frozen=True, slots=True)
class _Row:
    """A line with its words and where each begins, from 0."""

    line: int
    words: tuple[str, ...]
    starts: tuple[int, ...]


class _File:
    """The text of one file, for errors with their place."""

    def __init__(self, path: Path) -> None:
        self.name = str(path)
        try:
            self.text = read_text(path, self.name, "file of poses", _MOST_BYTES)
        except TextError as error:
            raise TrajectoryError(show(error.problem, {})) from None
        except OSError as error:
            raise TrajectoryError(f"{path} cannot be read: {error.strerror or error}") from None

    def error(self, message: str, row: _Row, column: int | None, hint: str) -> TrajectoryError:
        """An error at a word of a row; at the whole row without a column."""
        if column is None:
            start, length = row.starts[0], row.starts[-1] + len(row.words[-1]) - row.starts[0]
        else:
            start, length = row.starts[column], len(row.words[column])
        place = Place(self.name, row.line, start + 1, max(1, length))
        return TrajectoryError(show(Problem("", message, place, hint), {self.name: self.text}))


def read_trajectory(path: Path) -> Trajectory:
    """Read rows `t, x, y, z, qx, qy, qz, qw` in s and m, or as a header orders the columns.

    Lines that begin with # are comments. Commas, semicolons, tabs and blanks part the columns.

    Raises:
        TrajectoryError: the file is unreadable, or a row is wrong.
    """
    file = _File(path)
    order, named, rows = _rows(file)
    if not rows:
        raise TrajectoryError(
            f"{path} has no poses; expected rows {', '.join(COLUMNS)}, in s and m"
        )
    table = np.array([_numbers(file, row, order, named) for row in rows])
    quaternions = _unit(file, rows, table[:, 4:], order)
    kept = _ascending(file, rows, table, quaternions, order)
    return Trajectory(
        file.name,
        table[kept, 0],
        table[kept, 1:4],
        quaternions[kept],
        np.array([row.line for row in rows])[kept],
    )


def _rows(file: _File) -> tuple[tuple[int, ...], bool, list[_Row]]:
    """Which column each of t, x, … qw is, whether a header says so, and the rows of numbers."""
    order, named = tuple(range(len(COLUMNS))), False
    rows: list[_Row] = []
    for line, text in enumerate(file.text.splitlines(), 1):
        comment = text.lstrip().startswith("#")
        row = _row(line, text.replace("#", " ", 1) if comment else text)
        if row is None:
            continue
        names = None if rows else _header(row)
        if names is not None:
            order, named = names, True
        elif comment:
            continue
        elif not rows and all(math.isnan(_number(word)) for word in row.words):
            raise file.error(
                f"the header does not name the columns {', '.join(COLUMNS)}, each once",
                row, None, _hint(row),
            )  # fmt: skip
        else:
            rows.append(row)
    return order, named, rows


def _row(line: int, text: str) -> _Row | None:
    """The words of a line, without quotes; None if it has none. Empty columns at the end go."""
    parted = next((mark for mark in ";," if mark in text), "")
    found = re.finditer(f"[^{parted}]+|(?<={parted})(?={parted})" if parted else r"\S+", text)
    words = [(each[0].strip(_BLANK), _start(each)) for each in found]
    while words and not words[-1][0]:
        words.pop()
    if not words:
        return None
    return _Row(line, tuple(word for word, _ in words), tuple(start for _, start in words))


def _start(found: re.Match[str]) -> int:
    return found.start() + len(found[0]) - len(found[0].lstrip(_BLANK))


def _header(row: _Row) -> tuple[int, ...] | None:
    """The columns of t, x, … qw if a row names each of them once."""
    named: dict[str, int] = {}
    for index, word in enumerate(row.words):
        name = _named(word)
        if name is not None and named.setdefault(name, index) != index:
            return None
    return tuple(named[name] for name in COLUMNS) if len(named) == len(COLUMNS) else None


def _named(word: str) -> str | None:
    """`q_x`, `Timestamp [s]` and `pose.orientation.w` as the column that they mean."""
    plain = _UNITS.sub("", word).strip().strip("\"'").lower()
    last = ".".join(re.split(r"[./]", plain)[-2:])
    for text in (plain, last):
        found = _COLUMN.get(re.sub(r"[^a-z]", "", text))
        if found is not None:
            return found
    return None


def _hint(row: _Row) -> str:
    if any(word.lower() in _EULER for word in row.words):
        return "angles are not read; write quaternions"
    return "write it so, or begin the line with #"


def _number(word: str) -> float:
    """A number, also with a decimal comma; NaN if it is none."""
    try:
        return float(word.replace(",", "."))
    except ValueError:
        return math.nan


def _numbers(file: _File, row: _Row, order: tuple[int, ...], named: bool) -> list[float]:
    """The eight numbers of a row, in the order of COLUMNS. named: whether a header names them."""
    if len(row.words) <= max(order) or (len(row.words) > len(COLUMNS) and not named):
        raise file.error(
            f"the row has {len(row.words)} columns; expected {', '.join(COLUMNS)}",
            row, None, "angles or matrices are not read, write quaternions; further columns need a "
            "header that names all",
        )  # fmt: skip
    numbers = []
    for name, column in zip(COLUMNS, order, strict=True):
        word = row.words[column]
        number = _number(word)
        if not math.isfinite(number):
            raise file.error(
                f"{name} is {word!r}; expected a finite number", row, column, "delete the row"
            )
        numbers.append(number)
    return numbers


def _unit(
    file: _File, rows: list[_Row], quaternions: np.ndarray, order: tuple[int, ...]
) -> np.ndarray:
    """The quaternions w first, normalised if they are nearly unit quaternions."""
    lengths = np.linalg.norm(quaternions, axis=1)
    wrong = np.flatnonzero(abs(lengths - 1.0) > _NORMALISED)
    if len(wrong):
        row, length = rows[wrong[0]], float(lengths[wrong[0]])
        raise file.error(
            f"the quaternion has length {length:.3g}; expected 1",
            row, order[4],
            "columns qx, qy, qz, qw of a unit quaternion; neither degrees nor Euler angles",
        )  # fmt: skip
    return np.asarray((quaternions / lengths[:, None])[:, [3, 0, 1, 2]])


def _ascending(
    file: _File,
    rows: list[_Row],
    table: np.ndarray,
    quaternions: np.ndarray,
    order: tuple[int, ...],
) -> np.ndarray:
    """Which rows (N,) to keep: of equal stamps the first."""
    steps = np.diff(table[:, 0])
    back = np.flatnonzero(steps < 0)
    if len(back):
        row, before = rows[back[0] + 1], rows[back[0]]
        raise file.error(
            f"t goes back by {-steps[back[0]]:.6g} s, from {before.words[order[0]]} in line "
            f"{before.line}",
            row, order[0], f"sort the rows: sort -s -t, -k{order[0] + 1},{order[0] + 1}g FILE",
        )  # fmt: skip
    same = np.flatnonzero(steps == 0)
    apart = np.linalg.norm(table[same + 1, 1:4] - table[same, 1:4], axis=1)
    cosine = abs((quaternions[same + 1] * quaternions[same]).sum(axis=1))
    far = np.flatnonzero((apart > _SAME_PLACE) | (cosine < math.cos(_SAME_TURN / 2)))
    if len(far):
        row = rows[same[far[0]] + 1]
        raise file.error(
            f"another pose at the same time as in line {rows[same[far[0]]].line}",
            row, order[0], "expected one pose at a time; does the file mix two frames?",
        )  # fmt: skip
    return np.asarray(np.concatenate([[True], steps > 0]))
