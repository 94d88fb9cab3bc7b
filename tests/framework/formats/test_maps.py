"""Whatever bytes a map's files hold: a map, or a ValueError that names the file."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN, MapPicture, read_map, write_map

GOOD = {
    "image": "plan.pgm",
    "resolution": "0.05",
    "origin": "[-1.0, 2.0, 0.0]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}
PGM = b"P5\n3 2\n255\n" + bytes([0, 254, 205, 254, 254, 0])


def _write(folder: Path, pgm: bytes = PGM, **changes: str | None) -> Path:
    entries = {**GOOD, **changes}
    lines = [f"{key}: {value}" for key, value in entries.items() if value is not None]
    (folder / "plan.pgm").write_bytes(pgm)
    (folder / "plan.yaml").write_text("\n".join(lines) + "\n")
    return folder / "plan.yaml"


def _refused(path: Path) -> str:
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - what it says is checked by callers
        read_map(path)
    assert str(path.parent) in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("resolution", "-0.05"),
        ("resolution", ".nan"),
        ("resolution", ".inf"),
        ("resolution", "true"),
        ("resolution", None),
        ("origin", "[a, 0.0, 0.0]"),
        ("origin", "[null, 0.0, 0.0]"),
        ("origin", "[.nan, 0.0, 0.0]"),
        ("origin", "[[0.0], 0.0, 0.0]"),
        ("origin", "0.0"),
        ("origin", None),
        ("occupied_thresh", None),
        ("occupied_thresh", "high"),
        ("free_thresh", "[0.1]"),
        ("free_thresh", None),
    ],
)
def test_a_value_that_is_none_is_named(tmp_path: Path, key: str, value: str | None) -> None:
    said = _refused(_write(tmp_path, **{key: value}))
    assert key in said
    assert "is None" not in said


@pytest.mark.parametrize(
    "pgm",
    [
        b"P2 3 2 255\n0 1 2 3 4 five",
        b"P2 3 2 255\n0 1 2 3 4",
        b"P2 3 2 255\n0 1 2 3 4 5.5",
        b"P2 3 2 255\n0 1 2 3 4 \xff",
        b"P5 3 2 255\n\0\0\0\0\0",
        b"P5 3 2 65535\n" + bytes(11),
        b"P5 3 2 70000\n" + bytes(12),
        b"P5 3 2 0\n" + bytes(6),
        b"P5 -3 2 255\n" + bytes(6),
        b"P5 3 2",
        b"P5 99999 99999 255\n",
        b"# nothing but a comment",
        b"\x89PNG\r\n\x1a\n",
    ],
)
def test_a_broken_picture_is_named(tmp_path: Path, pgm: bytes) -> None:
    assert "plan.pgm" in _refused(_write(tmp_path, pgm))


@settings(max_examples=150)
@given(st.binary(max_size=40), st.sampled_from([b"", b"P5 ", b"P2 ", b"P5 2 2 255 ", b"P2 1 2 9 "]))
def test_any_bytes_are_a_map_or_named(body: bytes, head: bytes) -> None:
    with TemporaryDirectory() as folder:
        path = _write(Path(folder), head + body)
        says = ""
        cells = np.full((1, 1), FREE)
        try:
            cells = read_map(path).cells()
        except ValueError as error:
            says = str(error)
    assert says == "" or "plan.pgm" in says
    assert cells.size > 0
    assert set(np.unique(cells)) <= {FREE, OCCUPIED, UNKNOWN}


@settings(max_examples=100)
@given(st.text(max_size=40))
def test_any_text_is_named(text: str) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "plan.yaml"
        path.write_text(text, encoding="utf-8")
        assert "plan.yaml" in _refused(path)


def test_a_folder_is_no_map(tmp_path: Path) -> None:
    _refused(tmp_path / "." / "")
    (tmp_path / "plan.pgm").mkdir()
    (tmp_path / "plan.yaml").write_text("\n".join(f"{k}: {v}" for k, v in GOOD.items()))
    assert "plan.pgm" in _refused(tmp_path / "plan.yaml")


@settings(max_examples=40)
@given(
    st.integers(1, 9),
    st.integers(1, 9),
    st.sampled_from([255, 1, 100, 65535]),
    st.booleans(),
    st.integers(0, 1000),
)
def test_each_pixel_is_judged_by_the_thresholds(
    columns: int, rows: int, brightest: int, plain: bool, seed: int
) -> None:
    pixels = np.random.default_rng(seed).integers(0, brightest + 1, (rows, columns))
    wide = ">u2" if brightest > 255 else "u1"
    body = " ".join(map(str, pixels.ravel())).encode() if plain else pixels.astype(wide).tobytes()
    header = f"P{2 if plain else 5}\n# made by hand\n{columns} # wide\n{rows} {brightest}\n"
    with TemporaryDirectory() as folder:
        cells = read_map(_write(Path(folder), header.encode() + body)).cells()
    dark = 1.0 - pixels[::-1] / brightest
    expected = np.where(dark > 0.65, OCCUPIED, np.where(dark < 0.196, FREE, UNKNOWN))
    assert (cells == expected).all()


def test_bytes_after_the_picture_are_let_be(tmp_path: Path) -> None:
    assert read_map(_write(tmp_path, PGM + b"more")).cells().shape == (2, 3)


def test_a_picture_elsewhere_is_found_from_the_yamls_folder(tmp_path: Path) -> None:
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "floor.pgm").write_bytes(PGM)
    assert read_map(_write(tmp_path, b"", image="pictures/floor.pgm")).cells().shape == (2, 3)


YAML = """image: plan.pgm
resolution: 0.05
origin: [-1.0, 2.0, 0.0]
negate: {negate}
occupied_thresh: 0.65
free_thresh: 0.196
"""


def _write_text(folder: Path, pgm: bytes, text: str = YAML.format(negate=0)) -> Path:
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
    grid = read_map(_write_text(tmp_path, header + body, YAML.format(negate=negate)))
    assert grid.cells().tolist() == [[FREE, FREE, OCCUPIED], [OCCUPIED, FREE, UNKNOWN]]
    assert grid.origin == (-1.0, 2.0)
    assert grid.levels.shape == (2, 3)


@pytest.mark.parametrize(
    ("pgm", "text", "says"),
    [
        (b"P5 3 2 255\n12345", None, "truncated"),
        (b"GIF89a", None, "neither a PGM, a PNG nor a BMP"),
        (b"", None, "neither a PGM"),
        (b"P5 0 2 255\n", None, "neither a PGM"),
        (b"P5 1 1 255\n1", "[1, 2]", "not a map_server file"),
        (b"P5 1 1 255\n1", "a: [", "this is not YAML"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("0.05", "fine"), "resolution"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("0.05", "0"), "resolution"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("2.0, 0.0", "2.0"), "origin"),
        (b"P5 1 1 255\n1", YAML.format(negate=0) + "mode: scaled\n", "did you mean scale"),
        (b"P5 1 1 255\n1", YAML.format(negate="maybe"), "expected 0, or 1"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("0.65", "65"), "expected shares"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("0.65", "0.1"), "expected shares"),
        (b"P5 1 1 255\n1", YAML.format(negate=0).replace("plan.pgm", "else.pgm"), "else.pgm"),
    ],
)
def test_broken_files_are_named(tmp_path: Path, pgm: bytes, text: str | None, says: str) -> None:
    path = _write_text(tmp_path, pgm, text or YAML.format(negate=0))
    with pytest.raises(ValueError, match=says) as caught:
        read_map(path)
    assert str(tmp_path) in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="nowhere.yaml cannot be read"):
        read_map(tmp_path / "nowhere.yaml")


@given(
    st.sampled_from([255, 1, 100, 65535]), st.booleans(), st.integers(0, 1000), st.floats(-1e3, 1e3)
)
def test_what_is_written_is_read(brightest: int, negate: bool, seed: int, x: float) -> None:
    levels = np.random.default_rng(seed).integers(0, brightest + 1, (3, 4))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "plan.yaml"
        write_map(path, MapPicture(levels, 0.05, (x, 2.0), brightest, negate, 0.7, 0.2))
        found = read_map(path)
    assert (found.levels == levels).all()
    assert (found.brightest, found.origin, found.resolution) == (brightest, (x, 2.0), 0.05)
    assert (found.negate, found.occupied_thresh, found.free_thresh) == (negate, 0.7, 0.2)


def test_a_png_is_read_as_well(tmp_path: Path) -> None:
    Image.fromarray(np.array([[0, 254], [205, 254]], np.uint8)).save(tmp_path / "floor.png")
    found = read_map(_write(tmp_path, image="floor.png"))
    assert found.cells().tolist() == [[UNKNOWN, FREE], [OCCUPIED, FREE]]


@pytest.mark.parametrize("quarter", [1, 2, 3, -1, 5])
def test_a_plan_turned_by_right_angles_is_the_same_building(tmp_path: Path, quarter: int) -> None:
    plain = read_map(_write(tmp_path)).cells()
    yaw = quarter * np.pi / 2
    turned = read_map(_write(tmp_path, origin=f"[-1.0, 2.0, {yaw}]"))
    assert turned.cells().tolist() == np.rot90(plain[::-1], quarter)[::-1].tolist()
    corner = {1: (-1.1, 2.0), 2: (-1.15, 1.9), 3: (-1.0, 1.85)}[quarter % 4]
    assert turned.origin == pytest.approx(corner)


@given(st.floats(-4.0, 4.0).filter(lambda yaw: yaw != 0.0))
def test_a_turned_wall_stays_where_it_is_and_has_no_hole(yaw: float) -> None:
    levels = np.full((40, 60), 254, np.uint8)
    levels[20, 5:55] = 0
    with TemporaryDirectory() as folder:
        path = Path(folder) / "plan.yaml"
        write_map(path, MapPicture(levels, 0.05, (3.0, -2.0)))
        path.write_text(path.read_text().replace("-2.0, 0]", f"-2.0, {yaw}]"))
        plan = read_map(path)
    c, s = np.cos(yaw), np.sin(yaw)
    for along in np.arange(0.28, 2.72, 0.02):
        x, y = 3.0 + c * along - s * 0.975, -2.0 + s * along + c * 0.975
        column = int(np.floor((x - plan.origin[0]) / 0.05))
        row = int(np.floor((y - plan.origin[1]) / 0.05))
        assert plan.cells()[row, column] == OCCUPIED


def test_scale_takes_what_is_likelier_and_transparent_as_unknown(tmp_path: Path) -> None:
    picture = np.zeros((1, 4, 2), np.uint8)
    picture[0, :, 0], picture[0, :, 1] = [0, 255, 170, 100], [255, 255, 255, 255]
    picture[0, 1, 1] = 0
    Image.fromarray(picture, "LA").save(tmp_path / "plan.png")
    path = _write(tmp_path, image="plan.png", mode="scale")
    assert read_map(path).cells().tolist() == [[OCCUPIED, UNKNOWN, FREE, OCCUPIED]]


def test_raw_levels_are_percentages(tmp_path: Path) -> None:
    path = _write(tmp_path, b"P5\n4 1\n255\n" + bytes([0, 100, 40, 255]), mode="raw", negate="1")
    assert read_map(path).cells().tolist() == [[FREE, OCCUPIED, UNKNOWN, UNKNOWN]]
