"""`calibrate camera`: exact on exact points, wrong pictures, boards, each mistake's sentence."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from momantu_skills.calibration.camera import tag_edges
from momantu_skills.calibration.camera.board import Board, Seen, find
from momantu_skills.calibration.camera.lens import fit
from momantu_skills.calibration.camera.pictures import read_pictures
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.models import Model
from momantu_skills.perception.tags import detector
from momantu_worlds.scenes.catalogue.tags import tag_cells

from momantu_bt.cli import main
from momantu_bt.robots.plugins import load_robot
from tests.skills.scenery.boards import (
    CHESSBOARD,
    DISTORTION,
    MATRIX,
    SIZE,
    folder,
    picture,
    places,
    seen,
    sheet,
)

CHARUCO = Board("charuco", 7, 5, 0.03, 0.022)
APRILGRID = Board("aprilgrid", 4, 3, 0.04, gap=0.01)


@pytest.mark.parametrize("model", list(Model))
def test_a_lens_is_exact_on_exact_points(model: Model) -> None:
    found = fit(CHESSBOARD, seen(model, 0.0), SIZE, model)
    assert found.error < 0.01
    assert found.matrix == pytest.approx(MATRIX, abs=0.5)
    if model is not Model.PINHOLE8:  # of 8 coefficients, several sets give the same lens
        assert found.distortion == pytest.approx(DISTORTION[model], abs=0.02)


@pytest.mark.parametrize("model", [Model.PINHOLE, Model.FISHEYE])
def test_standard_deviations_are_those_of_the_errors(model: Model) -> None:
    ratios = []
    for seed in range(6):
        found = fit(CHESSBOARD, seen(model, 0.2, seed=seed), SIZE, model)
        off = [found.matrix[0, 0] - 520, found.matrix[1, 1] - 515, found.matrix[0, 2] - 330]
        ratios += list(np.array(off) / found.deviations[:3])
    assert 0.5 < np.sqrt(np.mean(np.square(ratios))) < 1.7


def test_a_wrong_picture_does_not_count() -> None:
    pictures = seen(Model.PINHOLE, 0.1)
    right = fit(CHESSBOARD, pictures, SIZE, Model.PINHOLE)
    assert right.used.all()
    pixels = pictures[5].pixels + np.random.default_rng(0).normal(size=(54, 2)) * 6.0
    pictures[5] = Seen(pictures[5].indices, pixels)
    found = fit(CHESSBOARD, pictures, SIZE, Model.PINHOLE)
    assert list(np.flatnonzero(~found.used)) == [5]
    assert found.matrix == pytest.approx(right.matrix, abs=2.0)


def test_a_wrong_point_does_not_count() -> None:
    pictures = seen(Model.PINHOLE, 0.1)
    right = fit(CHESSBOARD, pictures, SIZE, Model.PINHOLE)
    pictures[5].pixels[7] += (0.0, 3.0)
    found = fit(CHESSBOARD, pictures, SIZE, Model.PINHOLE)
    assert found.used.all()
    assert [list(np.flatnonzero(~each)) for each in found.kept] == [[]] * 5 + [[7]] + [[]] * 8
    assert found.matrix == pytest.approx(right.matrix, abs=0.5)


@pytest.mark.parametrize("index", range(4))
def test_corners_are_where_the_board_has_them(index: int) -> None:
    turn, shift = places(1, 4)[index]
    shown = find(CHESSBOARD, np.asarray(picture(CHESSBOARD, turn, shift), dtype=np.uint8))
    assert shown is not None
    exact, _ = cv2.projectPoints(CHESSBOARD.points(), turn, shift, MATRIX, np.zeros(5))
    true = np.asarray(exact, dtype=float).reshape(-1, 2)
    both = [each - true for each in (shown.pixels, shown.pixels[::-1])]
    off = min(both, key=lambda each: float(abs(each).max()))  # a turned board looks the same
    assert np.sqrt((off**2).sum(axis=1).mean()) < 0.09
    assert abs(off.mean(axis=0)).max() < 0.02


def test_a_board_that_is_never_tilted_tells_no_focal_length() -> None:
    pictures = []
    for shift in np.random.default_rng(0).uniform((-0.2, -0.1, 0.3), (0.0, 0.0, 0.5), (8, 3)):
        points = CHESSBOARD.points().reshape(-1, 1, 3)
        pixels, _ = cv2.projectPoints(points, np.zeros(3), shift, MATRIX, np.zeros(5))
        pictures.append(Seen(np.arange(54), np.asarray(pixels).reshape(-1, 2)))
    with pytest.raises(CalibrationError, match="all views are alike: between pictures the board"):
        fit(CHESSBOARD, pictures, SIZE, Model.PINHOLE)


def run(capsys: pytest.CaptureFixture[str], *options: object) -> tuple[int, str]:
    code = main(["calibrate", "camera", *map(str, options)])
    shown = capsys.readouterr()
    return code, shown.out if code == 0 else shown.err


def test_a_lens_is_written_into_a_robot_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = load_robot("fetch").source
    assert source is not None
    file = tmp_path / "robot.yaml"
    file.write_text(source.read_text("utf-8"), "utf-8")
    pictures = folder(tmp_path / "in", CHESSBOARD, 9)
    code, said = run(capsys, pictures, *CHESS, "--write", file, "--sensor", "head_camera")
    assert code == 0, said
    assert "head_camera: field of view 60.00 -> 63." in said
    before, after = source.read_text("utf-8").splitlines(), file.read_text("utf-8").splitlines()
    changed = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert [each[0].split(":")[0].strip() for each in changed] == ["horizontal_fov"]
    assert load_robot(str(file)).camera()[1].horizontal_fov == pytest.approx(1.1036, abs=0.01)


def test_robot_files_that_take_no_lens(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = load_robot("fetch").source
    assert source is not None
    file, pictures = tmp_path / "robot.yaml", folder(tmp_path / "in", CHESSBOARD, 5)
    assert "there is no robot file" in run(capsys, pictures, *CHESS, "--write", file)[1]
    assert "--sensor names a camera of" in run(capsys, pictures, *CHESS, "--sensor", "x")[1]
    text = source.read_text("utf-8")
    file.write_text(text, "utf-8")
    said = run(capsys, pictures, *CHESS, "--write", file, "--sensor", "hand_camera")[1]
    assert "has no camera 'hand_camera'" in said
    assert "head_camera" in said
    block = text[text.index("  head_camera:") : text.index("  laser:")]
    flow = ", ".join(line.split("#")[0].strip() for line in block.splitlines()[1:])
    file.write_text(text.replace(block, f"  head_camera: {{{flow}}}\n"), "utf-8")
    code, said = run(capsys, pictures, *CHESS, "--write", file)
    assert code == 2
    assert "head_camera is not written with a key in each line" in said


CHESS = ("--board", "chessboard 9x6", "--square", "25mm")


def test_pictures_of_a_chessboard(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pictures = folder(tmp_path / "in", CHESSBOARD, 9)
    cv2.imwrite(str(pictures / "zz.png"), np.full(SIZE[::-1], 128, np.uint8))
    yaml, plot = tmp_path / "camera.yaml", tmp_path / "plot.png"
    code, said = run(capsys, pictures, *CHESS, "-o", yaml, "--plot", plot, "--name", "eye")
    assert code == 0, said
    out = tmp_path / "camera.json"
    assert run(capsys, pictures, *CHESS, "--json", out)[0] == 0
    data = json.loads(out.read_text(encoding="utf-8"))
    assert f"fx {data['parameters']['fx']['value']:12.5f}" in said
    assert [each["used"] for each in data["pictures"]] == [True] * 9
    assert data["without_board"] == ["zz.png"]
    assert "9 pictures of 640 x 480 pixels count, of 10; model pinhole" in said
    assert "zz.png  no board" in said
    assert "9 pictures are few" in said
    text = yaml.read_text()
    assert "camera_name: eye\n" in text
    assert "distortion_model: plumb_bob\n" in text
    numbers = text.split("data: [")[1].split("]")[0].split(", ")
    assert np.reshape(list(map(float, numbers)), (3, 3)) == pytest.approx(MATRIX, abs=4.0)
    drawn = cv2.imread(str(plot))
    assert drawn is not None
    assert drawn.shape == (480, 640, 3)


def test_pictures_of_a_charuco_board(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pictures = folder(tmp_path / "in", CHARUCO, 8)
    board = ("--board", "charuco 7x5", "--square", "30mm", "--marker", "22mm")
    code, said = run(capsys, pictures, *board)
    assert code == 0, said
    assert "8 pictures of 640 x 480 pixels count" in said


@pytest.mark.parametrize("kalibr", [False, True])
def test_pictures_of_an_aprilgrid(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kalibr: bool
) -> None:
    pictures = folder(tmp_path / "in", APRILGRID, 6, kalibr)
    board = ("--board", "aprilgrid 4x3", "--square", "40mm", "--gap", "10mm")
    code, said = run(capsys, pictures, *board)
    assert code == 0, said
    assert "6 pictures of 640 x 480 pixels count" in said
    shown = read_pictures(pictures, APRILGRID)
    assert all(len(each.indices) > 40 for each in shown.seen)
    lens = fit(APRILGRID, shown.seen, shown.size, Model.PINHOLE)
    assert lens.error < 0.15
    assert lens.matrix[0, 0] == pytest.approx(MATRIX[0, 0], rel=0.01)


def test_a_small_blurred_tag_before_grey_is_found() -> None:
    """25 pixels with its white rim, white of 190 and black of 50 before grey of 110."""
    cells = np.kron(tag_cells(5) > 0, np.ones((20, 20)))
    fine = np.full((800, 800), 110.0)
    fine[300:500, 300:500] = np.where(cells > 0, 190.0, 50.0)
    blurred = cv2.GaussianBlur(fine, (0, 0), 8.0)
    gray = cv2.resize(blurred, (100, 100), interpolation=cv2.INTER_AREA).astype(np.uint8)
    assert 5 in detector.tags_in(np.asarray(gray))


def test_corners_of_tags_are_not_moved_by_blur() -> None:
    """A square of 60 pixels, from 50 to 110 and from 60 to 120, counted from pixels' middles."""
    flat = np.full((200, 200), 230, np.uint8)
    flat[60:120, 50:110] = 25
    true = np.array([[49.5, 119.5], [109.5, 119.5], [109.5, 59.5], [49.5, 59.5]])
    outward = true + 0.5 * np.sign(true - true.mean(axis=0))
    for sigma in (0.5, 1.0, 1.5):
        blurred = np.asarray(cv2.GaussianBlur(flat, (0, 0), sigma), dtype=np.uint8)
        found = tag_edges.refined(blurred, outward[None])[0]
        assert found == pytest.approx(true, abs=0.05)


def test_corners_of_tags_whose_edges_a_lens_bends_are_found_where_it_is_told() -> None:
    """Edges of 70 pixels that bulge by up to 1.5 pixels, painted sixteen times as large."""
    corners = np.array([[40.0, 110.0], [110.0, 112.0], [108.0, 42.0], [42.0, 40.0]])
    shares = np.linspace(0.0, 1.0, 60)[:-1, None]
    for bulges in ((1.5, 1.0, 0.5, 1.0), (-1.0, 0.5, 0.0, -0.5)):
        outline, middles = [], []
        for k, bulge in enumerate(bulges):
            start, end = corners[k], corners[(k + 1) % 4]
            way = end - start
            out = bulge * np.array([-way[1], way[0]]) / np.linalg.norm(way)
            middles.append(0.5 * (start + end) + out)
            outline.append(start + shares * way + 4.0 * shares * (1.0 - shares) * out)
        large = np.full((2400, 2400), 230, np.uint8)
        drawn = np.round(((np.concatenate(outline) + 0.5) * 16.0 - 0.5) * 16.0).astype(np.int32)
        cv2.fillPoly(large, [drawn], 25, shift=4)
        small = cv2.resize(large, (150, 150), interpolation=cv2.INTER_AREA)
        gray = np.asarray(cv2.GaussianBlur(small, (0, 0), 0.7), dtype=np.uint8)
        found = tag_edges.refined(gray, corners[None])
        told = tag_edges.bent(corners[None], np.array(middles)[None])
        assert np.abs(told).max() > 0.3
        assert found - told == pytest.approx(corners[None], abs=0.08)


def test_mirrored_pictures_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pictures = folder(tmp_path / "in", CHARUCO, 5)
    for file in pictures.iterdir():
        shown = cv2.imread(str(file))
        assert shown is not None
        cv2.imwrite(str(file), shown[:, ::-1])
    code, said = run(
        capsys, pictures, "--board", "charuco 7x5", "--square", "30mm", "--marker", "22mm"
    )
    assert code == 2
    assert "00.png shows it mirrored: is the picture flipped, or the print?" in said


def test_a_charuco_board_of_an_old_print_is_found() -> None:
    old = Board("charuco", 7, 6, 0.03, 0.022)
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    print_of = cv2.aruco.CharucoBoard((7, 6), old.square, old.marker, family)
    print_of.setLegacyPattern(True)
    flat = np.pad(np.asarray(print_of.generateImage((420, 360))), 40, constant_values=255)
    shown = find(old, flat)
    assert shown is not None
    assert len(shown.indices) == 30
    assert shown.pixels[0] == pytest.approx((40 + 60 - 0.5, 40 + 60 - 0.5), abs=0.3)


def test_a_chessboard_with_a_narrow_rim_in_a_dark_place_is_found() -> None:
    """Each square has 20 pixels; there is white for 3 pixels around the board, and then black."""
    print_of = sheet(CHESSBOARD, 20)[17:-17, 17:-17] // 2
    shown = find(CHESSBOARD, np.pad(print_of, 60))
    assert shown is not None
    first = 60 + 3 + 20 - 0.5
    corners = first + 20.0 * np.mgrid[0:9, 0:6].T.reshape(-1, 2)
    apart = np.linalg.norm(shown.pixels[:, None] - corners, axis=2).min(axis=1)
    assert apart.max() < 0.3


def test_single_pictures_of_another_size_do_not_count(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pictures = folder(tmp_path / "in", CHESSBOARD, 6)
    cv2.imwrite(str(pictures / "00a.png"), np.zeros((481, 641), np.uint8))
    code, said = run(capsys, pictures, *CHESS)
    assert code == 0, said
    assert "6 pictures of 640 x 480 pixels count, of 7" in said
    assert "00a.png  641 x 481 pixels, does not count" in said


@pytest.fixture(scope="module")
def four(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folder(tmp_path_factory.mktemp("four") / "in", CHESSBOARD, 4)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--board", "chessboard 8x6", "--square", "25mm"],
            "png shows another one: --board 'chessboard 9x6'",
        ),
        (["--board", "checkers 9x6", "--square", "25mm"], "is no board; expected 'chessboard 9x6'"),
        (["--board", "chessboard 9x2", "--square", "25mm"], "expected 3 to 50 columns and rows"),
        (["--board", "chessboard 9x6", "--square", "25"], "expected a length with its unit"),
        (["--board", "chessboard 9x6", "--square", "25 deg"], "is an angle; expected a length"),
        (["--board", "chessboard 9x6", "--square", "0mm"], "expected a length such as 25mm"),
        (["--board", "charuco 7x5", "--square", "3cm"], "needs --marker, a length below --square"),
        (["--board", "aprilgrid 4x3", "--square", "4cm"], "an AprilGrid needs --gap, the length"),
        (
            ["--board", "charuco 7x5", "--square", "3cm", "--marker", "2cm", "--dictionary", "9X9"],
            "--dictionary '9X9'; expected",
        ),
        (
            ["--board", "charuco 7x5", "--square", "3cm", "--marker", "2cm"],
            "in {folder}, no picture shows a charuco 7x5",
        ),
    ],
)
def test_wrong_options(
    four: Path, capsys: pytest.CaptureFixture[str], options: list[str], message: str
) -> None:
    code, said = run(capsys, four, *options)
    assert code == 2
    assert message.format(folder=four) in said


def test_folders_without_usable_pictures(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "is no folder" in run(capsys, tmp_path / "no", *CHESS)[1]
    assert "has no pictures" in run(capsys, tmp_path, *CHESS)[1]
    cv2.imwrite(str(tmp_path / "a.png"), np.zeros((48, 64), np.uint8))
    assert "no picture shows a chessboard 9x6" in run(capsys, tmp_path, *CHESS)[1]
    cv2.imwrite(str(tmp_path / "b.png"), np.zeros((64, 48), np.uint8))
    assert "has 48 x 64 pixels, a.png 64 x 48: one" in run(capsys, tmp_path, *CHESS)[1]
    (tmp_path / "b.png").write_text("no picture")
    assert "b.png is no picture that can be read" in run(capsys, tmp_path, *CHESS)[1]
