"""The tree as people see it: in the terminal, in a film, in a browser."""

from __future__ import annotations

import itertools

import pytest

from momantu_bt.record.film import FilmObserver
from momantu_bt.record.text.lines import running_text, tree_lines
from momantu_bt.record.view import ViewObserver
from momantu_bt.running.api import run
from momantu_bt.skill import Failure, In, Run, Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.registry import Registry


class Act(Skill):
    """Works for some ticks, then fails if it is told to."""

    ticks: int = In(2, doc="how many")
    fails: bool = In(False, doc="whether")
    failures = {"BROKEN": "broken"}

    def run(self, robot) -> Run:
        for index in range(self.ticks):
            yield f"part {index + 1}"
        if self.fails:
            raise Failure("BROKEN", "as told")


TREE = """momantu_bt: 1
main: Main
trees:
  Main:
    - act: {ticks: 1}
      name: first
    - Inner
    - act: {}
      name: last
  Inner:
    fallback:
      - act: {ticks: 1, fails: true}
        name: second
      - act: {ticks: 2}
        name: third
        retry: 2
"""


FAILING = TREE.replace("ticks: 2}", "ticks: 1, fails: true}")


class Camera:
    """Keeps the tree's lines of each tick."""

    def __init__(self):
        self.shots, self.headlines = [], []

    def ticked(self, run):
        root = run.built.root
        lines = tree_lines(root)
        self.shots.append([(line.depth, line.text, line.status) for line in lines])
        self.headlines.append(running_text(root))

    def close(self):
        pass


@pytest.fixture
def watched(tmp_path):
    def start(observer, world=None, text=TREE):
        file = tmp_path / "tree.yaml"
        file.write_text(text, encoding="utf-8")
        place = world or ScriptedWorld()
        report = run(
            file, world=place, registry=Registry(skills={"act": Act}), watch=lambda _: [observer]
        )
        return report, observer

    return start


def test_what_runs_is_shown_with_its_phase_and_what_has_not_begun_without(watched):
    _, camera = watched(Camera())
    assert camera.shots[0] == [
        (0, "sequence", "RUNNING"),
        (1, "first: act ticks 1, part 1", "RUNNING"),
        (1, "Inner", "IDLE"),
        (1, "last: act", "IDLE"),
    ]


def test_a_failure_below_what_runs_stays_in_sight_with_its_code(watched):
    _, camera = watched(Camera())
    during = camera.shots[2]
    failed = [text for _, text, status in during if status == "FAILURE"]
    assert len(failed) == 1
    assert failed[0].endswith(": BROKEN")
    running = [text for _, text, status in during if status == "RUNNING"]
    assert any("try 1" in text and "part 1" in text for text in running)


def test_depths_grow_by_one_at_most_and_the_root_comes_first(watched):
    _, camera = watched(Camera())
    for shot in camera.shots:
        depths = [depth for depth, _, _ in shot]
        assert depths[0] == 0
        assert all(0 < after <= before + 1 for before, after in itertools.pairwise(depths))


def test_the_headline_is_what_runs_deepest_and_at_the_end_the_end(watched):
    report, camera = watched(Camera())
    assert report.status == "SUCCESS"
    assert "part 1" in camera.headlines[0]
    assert camera.headlines[-1] == "SUCCESS"
    failed, camera = watched(Camera(), text=FAILING)
    assert failed.status == "FAILURE"
    assert camera.headlines[-1] == "FAILURE"


def test_of_what_has_ended_only_failures_are_opened(watched):
    _, camera = watched(Camera())
    assert max(depth for depth, _, _ in camera.shots[-1]) == 1
    _, camera = watched(Camera(), text=FAILING)
    assert max(depth for depth, _, _ in camera.shots[-1]) > 1
    failed = [text for _, text, status in camera.shots[-1] if status == "FAILURE"]
    assert len(failed) >= 3
    assert all(text.endswith(": BROKEN") for text in failed)


def test_a_film_has_ten_frames_a_second(watched, tmp_path):
    world = ScriptedWorld()
    film = FilmObserver(world.open_video(tmp_path / "film.txt", "title"))
    watched(film, world)
    title, *frames = (tmp_path / "film.txt").read_text().splitlines()
    assert title == "title"
    times = [float(frame.split()[0]) for frame in frames]
    assert times == pytest.approx(sorted(times))
    assert len(frames) == pytest.approx(10 * world.now(), abs=1)


def test_a_view_is_kept_up_to_date_and_closed(watched):
    class View:
        url, updates, closed = "", 0, 0

        def update(self):
            self.updates += 1

        def close(self):
            self.closed += 1

    view, world = View(), ScriptedWorld()
    watched(ViewObserver(view), world)
    assert view.updates == pytest.approx(10 * world.now(), abs=1)
    assert view.closed == 1
