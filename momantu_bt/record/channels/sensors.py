"""What the robot saw: `/camera/<name>` as small JPEGs, `/scan/<name>`."""

from __future__ import annotations

import base64
import io
import math

import numpy as np

from momantu_bt.engine.events import Events
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.skills.actuators import SensorRead
from momantu_bt.geometry import Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import CameraImage, LaserScan
from momantu_bt.record.channels.channel import stamp_of, time_text
from momantu_bt.record.channels.poses import pose_text
from momantu_bt.record.codec import dumps
from momantu_bt.record.mcap.file import McapFile
from momantu_bt.record.mcap.viewer_schemas import IMAGE, SCAN

with lazily():
    from PIL import Image


EVERY = 1.0
"""Simulated seconds between two kept readings of one sensor."""
_SLACK = 1e-6
WIDTH = 320
"""Greatest width of a kept picture, pixels."""
QUALITY = 70
_NOWHERE = pose_text(Transform())


class Sensors:
    """Writes readings with their stamps: one each EVERY seconds for each sensor that was read."""

    def __init__(self, events: Events) -> None:
        self._due: dict[str, float] = {}
        self._taken: dict[str, CameraImage | LaserScan] = {}
        events.subscribe(SensorRead, self._take)

    def _take(self, event: SensorRead) -> None:
        sensor, reading = event
        if reading.stamp >= self._due.get(sensor, reading.stamp) - _SLACK and isinstance(
            reading, CameraImage | LaserScan
        ):
            self._due[sensor] = reading.stamp + EVERY
            self._taken[sensor] = reading

    def taken(self) -> dict[str, CameraImage | LaserScan]:
        """Readings by sensor since the last call."""
        taken, self._taken = self._taken, {}
        return taken

    def write(self, run: Executor, file: McapFile) -> None:
        """Write every reading that was taken in this tick."""
        stamp = stamp_of(run.context.now)
        for name, reading in self.taken().items():
            if isinstance(reading, CameraImage):
                channel = file.channel(f"/camera/{name}", "foxglove.CompressedImage", IMAGE)
                file.add(channel, stamp, _image_text(reading))
            else:
                channel = file.channel(f"/scan/{name}", "foxglove.LaserScan", SCAN)
                file.add(channel, stamp, _scan_text(reading))


def jpeg(image: CameraImage) -> bytes:
    """The colours, made smaller by a whole factor so that they are at most WIDTH wide."""
    picture = Image.fromarray(np.ascontiguousarray(image.color))
    factor = math.ceil(picture.width / WIDTH)
    if factor > 1:
        picture = picture.reduce(factor)
    out = io.BytesIO()
    picture.save(out, "JPEG", quality=QUALITY)
    return out.getvalue()


def _image_text(image: CameraImage) -> str:
    data = base64.b64encode(jpeg(image)).decode("ascii")
    return (
        f'{{"timestamp":{time_text(image.stamp)},"frame_id":{dumps(image.frame)},'
        f'"data":"{data}","format":"jpeg"}}'
    )


def _scan_text(scan: LaserScan) -> str:
    """Ranges to the millimetre; a beam that hit nothing has the greatest range."""
    ranges = np.nan_to_num(scan.ranges, nan=0.0, posinf=scan.range_max, neginf=0.0)
    numbers = ",".join([f"{r:g}" for r in np.round(ranges, 3).tolist()])
    end = scan.angle_min + scan.angle_increment * (len(ranges) - 1)
    return (
        f'{{"timestamp":{time_text(scan.stamp)},"frame_id":{dumps(scan.frame)},'
        f'"pose":{_NOWHERE},"start_angle":{scan.angle_min!r},"end_angle":{end!r},'
        f'"ranges":[{numbers}],"intensities":[]}}'
    )
