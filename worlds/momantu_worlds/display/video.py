"""Films of a run: MP4 with H.264, written beside its final name until it is finished."""

from __future__ import annotations

import os
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import av

from momantu_bt.messages import CameraImage
from momantu_bt.world import TreeLine, WorldError
from momantu_worlds.display.chase import Chase
from momantu_worlds.display.frame import HEIGHT, SCENE, WIDTH, Image, compose
from momantu_worlds.sapien.sensors.camera_view import ViewCamera
from momantu_worlds.scenes.geometry.bodies import Episode

if TYPE_CHECKING:
    from momantu_worlds.sapien.simulator import Simulator

RATE = 10
"""Nominal frames per second; each frame carries its own time."""
FIELD_OF_VIEW = 1.05
"""rad; horizontal, of the third-person camera."""
TIME_BASE = Fraction(1, 1000)
"""s; unit of the film's time stamps."""


class Film:
    """Implements `momantu_bt.world.Video`."""

    def __init__(self, simulator: Simulator, episode: Episode, path: Path, title: str) -> None:
        """See `open_video`."""
        path = Path(os.path.realpath(path))  # a link stays a link
        self._simulator, self._path = simulator, path
        self._part = path.with_name(f".{path.stem}.part{path.suffix or '.mp4'}")
        self._part.touch()  # the encoder would open it with the first frame, too late to refuse
        self._chase = Chase(episode.bodies)
        self._camera = ViewCamera(simulator.scene, *SCENE, FIELD_OF_VIEW)
        self._head = simulator.robot.description.camera()[0]
        self._container: Any = av.open(str(self._part), "w", format="mp4")
        self._container.metadata["title"] = title
        self._stream = self._container.add_stream("libx264", rate=RATE)
        self._stream.width, self._stream.height = WIDTH, HEIGHT
        self._stream.pix_fmt = "yuv420p"
        self._stream.codec_context.time_base = TIME_BASE
        self._stream.options = {"preset": "ultrafast", "crf": "24", "threads": "1"}

    def add(self, lines: Sequence[TreeLine], headline: str) -> None:
        """Take one frame of now."""
        if self._container is None:
            return
        picture = self._picture(lines, headline)
        frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
        frame.pts, frame.time_base = round(self._simulator.now() / TIME_BASE), TIME_BASE
        self._container.mux(self._stream.encode(frame))

    def _picture(self, lines: Sequence[TreeLine], headline: str) -> Image:
        now = self._simulator.now()
        scene = self._camera.take(self._chase.pose(self._simulator.truth.base(), now))
        head = self._simulator.robot.peek(self._head)
        assert isinstance(head, CameraImage)
        return compose(scene, head.color, lines, headline)

    def close(self) -> None:
        """Finish the file and give it its name; safe to call twice."""
        if self._container is None:
            return
        container, self._container = self._container, None
        try:
            container.mux(self._stream.encode(None))
            container.close()
            self._part.replace(self._path)
        except BaseException:
            self._part.unlink(missing_ok=True)
            raise


def open_video(simulator: Simulator, episode: Episode, path: Path, title: str) -> Film:
    """Start a film of a simulation at `path`.

    Raises:
        WorldError: the file cannot be written there.
    """
    try:
        return Film(simulator, episode, path, title)
    except OSError as error:
        raise WorldError(f"the film {path} cannot be written: {error.strerror}") from error
