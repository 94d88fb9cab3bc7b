"""Films and views show a simulation and change nothing in it."""

import hashlib
import urllib.request

import av
import numpy as np
import pytest
from momantu_worlds.display.shapes import body_meshes, link_meshes, merged, still_meshes
from momantu_worlds.display.video import open_video
from momantu_worlds.display.view import open_view
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.catalogue.furniture import furniture
from momantu_worlds.scenes.geometry.bodies import Body
from momantu_worlds.testing import plain_episode

from momantu_bt.geometry import Transform
from momantu_bt.marker import Axes, Box, Grid, Line, Points, Text
from momantu_bt.messages import BaseVelocity
from momantu_bt.world import MarkerView, TreeLine, TreeView, WorldError

LINES = [TreeLine(0, "Bring", "RUNNING"), TreeLine(1, "navigate", "RUNNING")]
PORT = 18923


def drive(simulator: Simulator, ticks: int, after=lambda tick: None) -> str:
    """Drive a curve; a digest of every state on the way."""
    digest = hashlib.sha256()
    for tick in range(ticks):
        simulator.robot.command("base", BaseVelocity(0.3, 0.8))
        simulator.step()
        digest.update(simulator.state_bytes())
        after(tick)
    return digest.hexdigest()


@pytest.fixture
def simulator():
    made = Simulator(fetch(), plain_episode(), 0)
    yield made
    made.close()


def test_a_run_is_the_same_with_film_and_view_or_without(simulator, tmp_path):
    film = open_video(simulator, plain_episode(), tmp_path / "film.mp4", "a run")
    view = open_view(simulator, plain_episode(), PORT)

    def show(tick: int) -> None:
        if tick % 5 == 0:
            film.add(LINES, f"{simulator.now():.1f} s")
            view.update()

    shown = drive(simulator, 20, show)
    page = urllib.request.urlopen(view.url, timeout=10)
    assert page.status == 200
    for thing in (film, film, view, view):
        thing.close()
    plain = Simulator(fetch(), plain_episode(), 0)
    assert drive(plain, 20) == shown
    with av.open(str(tmp_path / "film.mp4")) as container:
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    assert [f.shape for f in frames] == [(720, 1280, 3)] * 4
    assert np.abs(frames[0].astype(int) - frames[-1].astype(int)).max() > 50
    assert [path.name for path in tmp_path.iterdir()] == ["film.mp4"]


def test_a_film_carries_the_simulations_time(simulator, tmp_path):
    film = open_video(simulator, plain_episode(), tmp_path / "film.mp4", "a run")
    times = []
    for _ in range(3):
        simulator.step()
        simulator.step()
        film.add([], "")
        times.append(simulator.now())
    film.close()
    with av.open(str(tmp_path / "film.mp4")) as container:
        stamps = [float(frame.time) for frame in container.decode(video=0)]
    assert np.allclose(np.diff(stamps), np.diff(times), atol=0.002)


def test_a_film_that_cannot_be_written_is_a_world_error(simulator, tmp_path):
    with pytest.raises(WorldError, match="cannot be written"):
        open_video(simulator, plain_episode(), tmp_path / "no" / "film.mp4", "a run")


def test_a_port_in_use_is_a_world_error(simulator):
    view = open_view(simulator, plain_episode(), PORT + 1)
    with pytest.raises(WorldError, match="choose another port"):
        open_view(simulator, plain_episode(), PORT + 1)
    view.close()


def test_bodies_that_come_and_go_are_shown_while_they_are_there(simulator):
    view = open_view(simulator, plain_episode(), PORT + 2)
    crate = Body("crate", "crate", Transform((2.0, 1.0, 0.0)), furniture("crate"))
    own = set(view.shown)
    simulator.add(crate)
    view.update()
    assert set(view.shown) - own == {"crate"}
    simulator.remove("crate")
    view.update()
    assert set(view.shown) == own
    simulator.add(crate)
    view.update()
    assert "crate" in view.shown
    simulator.remove("crate")
    view.close()


def test_markers_are_shown_replaced_and_erased(simulator):
    view = open_view(simulator, plain_episode(), PORT + 3)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]
    markers = [
        Line("line", corners, closed=True),
        Points("points", [*corners, (float("nan"), 0, 0)]),
        Points("nothing", [(float("nan"), 0, 0)]),
        Box("box", Transform((1, 1, 1)), (0.1, 0.2, 0.3), color=(1, 0, 0, 0.5)),
        Axes("axes", Transform((0, 0, 1))),
        Text("text", (0, 0, 1), "here"),
        Grid("grid", np.linspace(0.0, 1.0, 6).reshape(2, 3), (0.0, 0.0), 0.05),
        Grid("empty", np.zeros((0, 0)), (0.0, 0.0), 0.05),
    ]
    for marker in (*markers, markers[0]):
        view.draw(f"1 node/{marker.name}", marker, Transform((1.0, 0.0, 0.0)))
    there = [marker for marker in markers if marker.name != "empty"]
    assert sorted(view.marked) == sorted(f"1 node/{marker.name}" for marker in there)
    view.erase("1 node/line")
    view.erase("1 node/line")
    assert "1 node/line" not in view.marked
    assert isinstance(view, MarkerView)
    view.close()


def test_the_panel_has_the_tree_and_at_the_end_how_it_ended(simulator):
    view = open_view(simulator, plain_episode(), PORT + 4)
    view.tell("1.0 s  navigate", [*LINES, TreeLine(1, "on A → a < b", "IDLE")])
    assert "1.0 s  navigate" in view.told
    assert "on A → a &lt; b" in view.told
    view.end("Bring succeeded")
    assert isinstance(view, TreeView)
    assert not view.dismissed
    view.close()


def test_meshes_of_one_colour_are_joined_without_losing_a_triangle():
    bodies = plain_episode().bodies
    whole = [mesh for body in bodies for mesh in body_meshes(body)]
    joined = still_meshes(bodies)
    assert sum(len(m.faces) for m in joined) == sum(len(m.faces) for m in whole)
    assert len({m.color for m in joined}) == len(joined)
    assert all(m.faces.max() < len(m.vertices) for m in joined)
    assert merged([]) == []


def test_the_robots_links_are_there_to_be_seen(simulator):
    meshes = {name: link_meshes(link) for name, link in simulator.model.links.items()}
    assert meshes["gripper_link"]
    heights = [
        simulator.truth.link(name).apply(mesh.vertices)[:, 2]
        for name, parts in meshes.items()
        for mesh in parts
    ]
    every = np.concatenate(heights)
    assert -0.02 < every.min() < 0.1
    assert 0.8 < every.max() < 1.3
