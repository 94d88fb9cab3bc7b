"""What the robot saw: `/camera/<name>` as small JPEGs, `/scan/<name>`."""

from __future__ import annotations

import base64
import io
import math

import numpy as np

from momantu_bt.engine.executor import Executor
from momantu_bt.geometry import Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import CameraImage, LaserScan
from momantu_bt.record.channel import stamp_of, time_text
from momantu_bt.record.codec import dumps
from momantu_bt.record.mcap_file import McapFile
from momantu_bt.record.poses import pose_text
from momantu_bt.record.tap import Tap
from momantu_bt.record.viewer_schemas import IMAGE, SCAN

with lazily():
    from PIL import Image


WIDTH = 320
"""Pixels that a kept picture is at most wide."""
QUALITY = 70
_NOWHERE = pose_text(Transform())


class Sensors:
    """Writes what the tap has taken, with the stamps of the readings."""

    def __init__(self, tap: Tap) -> None:
        self._tap = tap

    def write(self, run: Executor, file: McapFile) -> None:
        """Every reading that was taken in this tick."""
        if not self._tap.taken:
            return
        taken, stamp = dict(self._tap.taken), stamp_of(run.context.now)
        self._tap.taken.clear()
        for name, reading in taken.items():
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
    """Ranges to the millimetre; where nothing was hit, the greatest range."""
    ranges = np.nan_to_num(scan.ranges, nan=0.0, posinf=scan.range_max, neginf=0.0)
    numbers = ",".join([f"{r:g}" for r in np.round(ranges, 3).tolist()])
    end = scan.angle_min + scan.angle_increment * (len(ranges) - 1)
    return (
        f'{{"timestamp":{time_text(scan.stamp)},"frame_id":{dumps(scan.frame)},'
        f'"pose":{_NOWHERE},"start_angle":{scan.angle_min!r},"end_angle":{end!r},'
        f'"ranges":[{numbers}],"intensities":[]}}'
    )
