"""The camera of a view goes where the robot goes, and stays where a person has turned it."""

from types import SimpleNamespace

import numpy as np
import pytest
from momantu_worlds.display.following import AWAY, FOCUS, Following

from momantu_bt.geometry import Pose2D


def browser(position, told=1.0):
    camera = SimpleNamespace(position=np.array(position), update_timestamp=told)
    return SimpleNamespace(camera=camera)


@pytest.fixture
def server():
    clients = {1: browser((1.0, 2.0, 3.0)), 2: browser((0.0, 0.0, 9.0)), 3: browser((0, 0, 0), 0.0)}
    return SimpleNamespace(
        initial_camera=SimpleNamespace(), get_clients=lambda: clients, clients=clients
    )


def test_every_camera_makes_the_robots_way(server):
    following = Following(server, Pose2D(0.0, 0.0, 0.0))
    following.move(Pose2D(0.5, 0.0, 1.0), follows=True)
    following.move(Pose2D(0.5, -1.0, 2.0), follows=True)
    assert server.clients[1].camera.position == pytest.approx([1.5, 1.0, 3.0])
    assert server.clients[2].camera.position == pytest.approx([0.5, -1.0, 9.0])
    assert server.clients[3].camera.position == pytest.approx([0.0, 0.0, 0.0])
    focus = np.array([0.5, -1.0, FOCUS])
    assert server.initial_camera.look_at == pytest.approx(focus)
    assert server.initial_camera.position == pytest.approx(focus + AWAY)


def test_switched_off_it_leaves_the_cameras_alone_and_goes_on_from_there(server):
    following = Following(server, Pose2D(0.0, 0.0, 0.0))
    following.move(Pose2D(5.0, 0.0, 0.0), follows=False)
    assert server.clients[1].camera.position == pytest.approx([1.0, 2.0, 3.0])
    following.move(Pose2D(5.5, 0.0, 0.0), follows=True)
    assert server.clients[1].camera.position == pytest.approx([1.5, 2.0, 3.0])
