"""record_picture: keep a picture of a board for `calibrate camera`, and say what is missing."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from momantu_bt.lazy import lazily
from momantu_bt.robot import Robot, read_camera
from momantu_bt.skill import Failure, In, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_skills.perception.camera.standing import until_standing

with lazily():
    from momantu_skills.calibration.camera import board as boards
    from momantu_skills.calibration.camera import collecting
    from momantu_skills.calibration.camera import pictures as files
    from momantu_skills.calibration.errors import CalibrationError

BUDGET = 0.1
"""Time allowed for searching one picture, s."""


class RecordPicture(Skill):
    """Add a picture of a board to a folder for `calibrate camera`; log what they cover so far."""

    folder: str = In(doc="the folder; it is made if it does not exist")
    board: str = In(doc="as `--board` of `calibrate camera`: aprilgrid 6x6, chessboard 9x6, …")
    square: float = In(unit="m", least=0.001, most=1, doc="edge of a square or tag")
    gap: float = In(0.0, unit="m", least=0, most=1, doc="between two tags of an AprilGrid")
    marker: float = In(0.0, unit="m", least=0, most=1, doc="edge of a ChArUco board's marker")
    dictionary: str = In("4X4_50", doc="of a ChArUco board's markers")
    pictures: int = Out(doc="how many pictures the folder has")
    covered: int = Out(doc="how much of the picture the boards cover, per cent")
    enough: bool = Out(doc="whether picture and angles are covered well")
    also_called = ("save_picture", "capture_board")
    failures = {
        "BOARD_NOT_SEEN": "the board is not in the picture",
        "BAD_BOARD": "there is no such board, or the folder has pictures of another one",
        "STILL_MOVING": "the robot does not come to rest",
        "PICTURE_NOT_WRITTEN": "the folder or its index cannot be read or written",
    }
    senses = {"camera"}
    activities = {}
    symptoms = {"BOARD_NOT_SEEN": {Symptom.NOT_SEEN}}

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A usual board; where it is not in view nothing is written."""
        return {"inputs": {"folder": "pictures", "board": "chessboard 9x6", "square": 0.025}}

    def run(self, robot: Robot) -> Run:
        """Wait until the robot stands, find the board, keep the picture."""
        folder = Path(self.folder)
        try:
            given = boards.read_board(
                self.board, self.square, self.marker, self.dictionary, self.gap
            )
        except CalibrationError as error:
            raise Failure("BAD_BOARD", str(error)) from None
        try:
            before = collecting.read_index(folder)
        except CalibrationError as error:
            raise Failure("PICTURE_NOT_WRITTEN", str(error)) from None
        other = next((each.board for each in before if each.board != str(given)), None)
        if other is not None:
            raise Failure("BAD_BOARD", f"{folder} has pictures of {other!r}; name another folder")
        yield from until_standing(robot)
        image = read_camera(robot)
        gray = files.gray_of(image.color)
        seen: boards.Seen | None = yield from compute(
            partial(boards.find, given, gray), budget=BUDGET
        )
        if seen is None:
            raise Failure("BOARD_NOT_SEEN", f"the camera's picture shows no {given}")
        name = f"picture_{len(before):03}.png"
        size = (gray.shape[1], gray.shape[0])
        new = collecting.picture_of(name, given, seen, size, image.intrinsics)
        _keep(folder, new, image.color)
        self._tell([*before, new])

    def _tell(self, pictures: list[collecting.Picture]) -> None:
        """Log the coverage, and what further pictures should show."""
        missing = collecting.wanted(pictures)
        self.pictures, self.covered = len(pictures), round(100 * collecting.share(pictures))
        self.enough = not missing
        self.log(f"{len(pictures)} pictures cover {self.covered} % of the picture:")
        for row in collecting.drawn(pictures):
            self.log(f"  {row}")
        self.log(f"missing: {'; '.join(missing)}" if missing else "nothing is missing")


def _keep(folder: Path, picture: collecting.Picture, color: Any) -> None:
    """Write the picture and its line; raises Failure PICTURE_NOT_WRITTEN."""
    data = files.png_of(color)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / picture.name).write_bytes(data)
        with (folder / collecting.INDEX).open("a", encoding="utf-8") as index:
            index.write(collecting.line_of(picture))
    except OSError as error:
        raise Failure("PICTURE_NOT_WRITTEN", f"{folder}: {error.strerror or error}") from None
