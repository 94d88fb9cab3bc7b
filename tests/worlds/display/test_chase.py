"""The film's camera follows the robot, and no wall stands between."""

import math
from itertools import pairwise

import numpy as np
import pytest
from momantu_worlds.display.chase import Chase, ChaseConfig, looking
from momantu_worlds.scenes.loading import draw_episode

from momantu_bt.geometry import Pose2D, wrap_angle

EPISODE = draw_episode("four_rooms", 0)
WALLS = [body for body in EPISODE.bodies if body.category == "wall"]
PLACES = [*EPISODE.site.places.values(), Pose2D(-3.4, 1.7, 1.57), Pose2D(-10.6, 7.5, 0.5)]


def blocked(eye, at) -> bool:
    """Whether a wall holds a point of the way, by sampling it every centimetre or so."""
    way = eye + np.linspace(0, 1, 400)[:, None] * (at - eye)
    for wall in WALLS:
        part = wall.parts[0]
        half = np.array(part.geometry.size) / 2
        own = (wall.map_from_body @ part.body_from_part).inverse().apply(way)
        if np.any(np.all(np.abs(own) < half, axis=1)):
            return True
    return False


@pytest.mark.parametrize("place", PLACES)
def test_no_wall_hides_a_robot_that_stands(place):
    pose = Chase(EPISODE.bodies).pose(place, 0.0)
    for height in (0.25, 0.9):
        assert not blocked(pose.position, np.array([place.x, place.y, height]))


@pytest.mark.parametrize("place", PLACES)
def test_it_looks_at_the_robot_from_above_the_walls(place):
    pose = Chase(EPISODE.bodies).pose(place, 0.0)
    towards = np.array([place.x, place.y, 0.75]) - pose.position
    off = math.acos(float(pose.rotation[:, 0] @ towards) / float(np.linalg.norm(towards)))
    assert off < 0.2
    assert pose.position[2] > 2.5


def test_it_goes_round_no_faster_than_it_may_and_catches_up():
    config = ChaseConfig()
    chase = Chase([], config)
    turns = [chase.pose(Pose2D(0, 0, 0.0), 0.0)]
    turns += [chase.pose(Pose2D(0, 0, 3.0), 0.1 * i) for i in range(1, 80)]
    around = [math.atan2(-t.rotation[1, 0], -t.rotation[0, 0]) for t in turns]
    steps = [abs(wrap_angle(b - a)) for a, b in pairwise(around)]
    # the focus moves as well, by at most a few hundredths of a rad a frame
    assert max(steps) < config.rate * 0.1 + 0.06
    assert steps[-1] < 1e-3


def test_a_camera_that_looks_has_its_z_up():
    pose = looking(np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.0, 0.5]))
    assert pose.rotation[2, 2] > 0
    assert pose.rotation[2, 1] == pytest.approx(0.0, abs=1e-12)
    assert np.linalg.det(pose.rotation) == pytest.approx(1.0)
