"""A world in SAPIEN: an episode, the robot in it, a referee who watches."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from momantu_bt.claim import Sentence
from momantu_bt.geometry import Transform
from momantu_bt.robot import RobotDescription
from momantu_bt.world import Site, Verdict, Video, View
from momantu_worlds.sapien.robot import SimulatedRobot
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.bodies import Episode
from momantu_worlds.scenes.judge import ClaimJudge
from momantu_worlds.scenes.loading import world_path
from momantu_worlds.scenes.referee import Referee


class SapienWorld:
    """Implements `momantu_bt.world.World` and `momantu_bt.claim.Judge`."""

    def __init__(
        self,
        name: str,
        description: RobotDescription,
        episode: Episode,
        seed: int,
        *,
        referee: bool = True,
    ) -> None:
        self._name, self._episode = name, episode
        self.simulator = Simulator(description, episode, seed)
        wanted = referee and episode.goal is not None
        hand = description.end_effector.frame
        self._referee = Referee(episode, self.simulator.truth, hand) if wanted else None
        self._bodies = {body.name: body for body in episode.bodies}

    @property
    def name(self) -> str:
        """The world's name."""
        return self._name

    @property
    def site(self) -> Site:
        """What the robot is told of this episode."""
        return self._episode.site

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

    def verdict(self) -> Verdict | None:
        """The referee's word on this instant; None without a referee."""
        return None if self._referee is None else self._referee.verdict()

    def judge(self, sentence: Sentence, odom_from_base: Transform) -> bool | None:
        """Whether something that a skill claims is true of this instant."""
        judge = ClaimJudge(self.robot.description, self._bodies, self.simulator.truth)
        return judge.judge(sentence, odom_from_base)

    def open_video(self, path: Path, title: str) -> Video:
        """Start a film at `path`."""
        from momantu_worlds.display.video import open_video

        return open_video(self.simulator, self._episode, path, title)

    def open_view(self, port: int) -> View:
        """Serve the scene to a browser on this machine."""
        from momantu_worlds.display.view import open_view

        return open_view(self.simulator, self._episode, port)

    def texts(self) -> Mapping[str, str]:
        """The world file, by its name."""
        path = world_path(self._name)
        return {path.name: path.read_text(encoding="utf-8")}

    def close(self) -> None:
        """Free the scene; safe to call twice."""
        self.simulator.close()
