"""A world in SAPIEN: an episode, its robot, and a referee."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from momantu_bt.claim import Sentence
from momantu_bt.fault import Effect, Fault
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.goal import Goal
from momantu_bt.lazy import lazily
from momantu_bt.robot import RobotDescription
from momantu_bt.world import Site, Verdict, Video, View, WorldError
from momantu_worlds.sapien.actors import crowd_of
from momantu_worlds.sapien.faults.rows import possible, prepare
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.robot import SimulatedRobot
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.arrange.episode import goal_of
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.referee.hand import hand_of
from momantu_worlds.scenes.referee.judge import ClaimJudge
from momantu_worlds.scenes.referee.referee import Referee

with lazily():
    from momantu_worlds.display import video, view


class SapienWorld:
    """Implements `World`, and `Judge` and `FaultyWorld` of the framework's contracts."""

    def __init__(
        self,
        path: Path,
        description: RobotDescription,
        episode: Episode,
        seed: int,
        *,
        referee: bool = True,
    ) -> None:
        """path: the world file that the episode was drawn from."""
        self._path, self._episode = path, episode
        self._description = description
        self.simulator = Simulator(description, episode, seed)
        crowd = crowd_of(self.simulator, episode, seed) if episode.actors else None
        self._people: frozenset[str] = frozenset() if crowd is None else crowd.names
        self._referee = self._referee_of(episode) if referee and episode.goals else None
        self._stage = Stage(self.simulator, episode, description, seed, self._referee, crowd)

    def _referee_of(self, judged: Episode) -> Referee:
        return Referee(judged, self.simulator.truth, hand_of(self._description), self._people)

    @property
    def name(self) -> str:
        """The world's name."""
        return self._episode.name

    @property
    def site(self) -> Site:
        """The site of this episode."""
        return self._episode.site

    @property
    def start(self) -> Pose2D:
        """See `momantu_bt.world.MeasuredWorld`."""
        return self._episode.start

    @property
    def robot(self) -> SimulatedRobot:
        """The robot's driver."""
        return self.simulator.robot

    def now(self) -> float:
        """Seconds since the episode began."""
        return self.simulator.now()

    def step(self) -> None:
        """Advance by one tick."""
        self.simulator.step()
        if self._referee is not None:
            self._referee.observe(self.simulator.now())

    def demand(self, goal: Goal | None) -> None:
        """See `momantu_bt.goal.DemandingWorld.demand`. Faults stay with the world's own goal."""
        demands = () if goal is None else goal.demands
        judged = replace(
            self._episode,
            goals=tuple(map(goal_of, demands)),
            goals_place="" if goal is None else goal.place,
        )
        try:
            self._referee = self._stage.referee = self._referee_of(judged)
        except (KeyError, ValueError) as error:
            place = "" if goal is None else f" ({goal.place})"
            raise WorldError(f"the goal{place} is not possible here: {error.args[0]}") from None

    def verdict(self) -> Verdict | None:
        """The referee's verdict on the current state; None without a referee."""
        return None if self._referee is None else self._referee.verdict()

    def judge(self, sentence: Sentence, odom_from_base: Transform) -> bool | None:
        """Whether a skill's claim is true at this moment."""
        bodies = {body.name: body for body in self._stage.bodies}
        judge = ClaimJudge(self.robot.description, bodies, self.simulator.truth)
        return judge.judge(sentence, odom_from_base)

    def faults(self) -> tuple[str, ...]:
        """Names of the faults that this episode can have."""
        return possible(self._stage)

    def effect(self, fault: Fault) -> Effect:
        """Prepare a fault; raises FaultError if it is not possible in this episode."""
        return prepare(self._stage, fault)

    def open_video(self, path: Path, title: str) -> Video:
        """Start a video at `path`."""
        return video.open_video(self.simulator, self._episode, path, title)

    def open_view(self, port: int) -> View:
        """Serve the scene to a browser on this machine."""
        return view.open_view(self.simulator, self._episode, port)

    def texts(self) -> Mapping[str, str]:
        """The world file, by its name."""
        return {self._path.name: self._path.read_text(encoding="utf-8", errors="replace")}

    def close(self) -> None:
        """Free the scene; safe to call twice."""
        self.simulator.close()
