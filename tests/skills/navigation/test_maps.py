"""Maps: what is written is read, and what is broken is named."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from momantu_skills.navigation.map.maps import FREE, OCCUPIED, UNKNOWN, GridMap, read_map

YAML = """image: plan.pgm
resolution: 0.05
origin: [-1.0, 2.0, 0.0]
negate: {negate}
occupied_thresh: 0.65
free_thresh: 0.196
"""


def _write(folder: Path, pgm: bytes, text: str = YAML.format(negate=0)) -> Path:
    (folder / "plan.pgm").write_bytes(pgm)
    (folder / "plan.yaml").write_text(text)
    return folder / "plan.yaml"


@pytest.mark.parametrize("plain", [True, False])
@pytest.mark.parametrize("negate", [0, 1])
def test_trinary_values_and_row_order(tmp_path: Path, plain: bool, negate: int) -> None:
    pixels = [0, 254, 205, 254, 254, 0]
    if negate:
        pixels = [255 - p for p in pixels]
    body = " ".join(map(str, pixels)).encode() if plain else bytes(pixels)
    header = b"P2\n# a comment\n3 2 255\n" if plain else b"P5\n# a comment\n3 2\n255\n"
    grid = read_map(_write(tmp_path, header + body, YAML.format(negate=negate)))
    assert grid.cells.tolist() == [[FREE, FREE, OCCUPIED], [OCCUPIED, FREE, UNKNOWN]]
    assert grid.origin == (-1.0, 2.0)
    assert grid.size == pytest.approx((0.15, 0.1))


@given(arrays(np.bool_, (7, 5)), st.floats(-3, 3), st.floats(-3, 3))
def test_centers_and_index_are_inverse(mask: np.ndarray, x: float, y: float) -> None:
    grid = GridMap(np.zeros((7, 5), np.uint8), 0.1, (x, y))
    cells = [grid.index(*point) for point in grid.centers(mask)]
    assert cells == [tuple(cell) for cell in np.argwhere(mask)]


def test_contains_the_edges_only_once() -> None:
    grid = GridMap(np.zeros((2, 4), np.uint8), 0.5, (0.0, 0.0))
    assert grid.contains(0.0, 0.0)
    assert grid.contains(1.99, 0.99)
    assert not grid.contains(2.0, 0.5)
    assert not grid.contains(1.0, -0.01)


@pytest.mark.parametrize(
    ("pgm", "text", "says"),
    [
        (b"P5 3 2 255\n12345", None, "ends early"),
        (b"P6 1 1 255\n123", None, "no PGM picture"),
        (b"", None, "no PGM picture"),
        (b"P5 0 2 255\n", None, "no sensible map"),
        (b"P5 1 1 255\n1", "[1, 2]", "no map_server file"),
        (b"P5 1 1 255\n1", "a: [", "is not YAML"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("0.05", "fine"), "resolution"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("0.05", "0"), "resolution"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("2.0, 0.0", "2.0, 0.3"), "yaw"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("2.0, 0.0", "2.0"), "origin"),
        (b"P5 1 1 255\n1", YAML.format(negate=0) + "mode: scale\n", "trinary"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("plan.pgm", "else.pgm"), "else.pgm"),
    ],
)
def test_broken_files_are_named(tmp_path: Path, pgm: bytes, text: str | None, says: str) -> None:
    path = _write(tmp_path, pgm, text or YAML.format(negate=0))
    with pytest.raises(ValueError, match=says) as caught:
        read_map(path)
    assert str(tmp_path) in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="nowhere.yaml cannot be read"):
        read_map(tmp_path / "nowhere.yaml")
