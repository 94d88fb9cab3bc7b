"""The picture that `momantu-bt worlds preview` writes: the plan, and the view beneath it."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from momantu_bt.lazy import lazily
from momantu_bt.robot import RobotDescription
from momantu_worlds.checking.measures import measured
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.preview.plan import draw_plan, extent
from momantu_worlds.scenes.geometry.bodies import Episode

with lazily():
    from momantu_worlds.preview import view as rendered

WIDTH = 1500
"""px; of the plan and of the view."""
GAP = 16
"""px between them."""
LEAST = 1.0
"""m; the view reaches at least so high above the floor."""


def page(episode: Episode, description: RobotDescription, *, view: bool = True) -> bytes:
    """A PNG of an episode.

    view: whether a rendered view comes beneath the plan; it needs a simulator.

    Raises:
        WorldError: the robot cannot be simulated, or nothing renders.
    """
    scenario = Scenario(episode, measured(description), lambda name: ())
    pictures = [draw_plan(scenario, WIDTH)]
    if view:
        low, high = extent(scenario)
        top = max([LEAST, *(float(s.box[1][2]) for own in scenario.solids.values() for s in own)])
        pictures.append(
            rendered.draw_view(
                episode, description, np.array([*low, 0.0]), np.array([*high, top]), WIDTH
            )
        )
    out = io.BytesIO()
    _stacked(pictures).save(out, "PNG", optimize=True)
    return out.getvalue()


def _stacked(pictures: list[Image.Image]) -> Image.Image:
    """Pictures one beneath the other on white."""
    width = max(picture.width for picture in pictures)
    height = sum(picture.height for picture in pictures) + GAP * (len(pictures) - 1)
    sheet = Image.new("RGB", (width, height), (255, 255, 255))
    top = 0
    for picture in pictures:
        sheet.paste(picture, ((width - picture.width) // 2, top))
        top += picture.height + GAP
    return sheet
