"""What the actions of Nav2 share: error codes as numbers, and the vehicle with Nav2's costmap."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from momantu_bt.robot import Robot
from momantu_bt.service import Localization
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill
from momantu_skills.nav2.service import Nav2Service
from momantu_skills.navigation.drive.body import BodyScene
from momantu_skills.navigation.drive.vehicle import Vehicle


class OnCostmap(Skill):
    """The base of leaves that work with the costmap that all of them share."""

    localization: Localization = Needs()
    planning_scene: BodyScene = Needs()
    nav2: Nav2Service = Needs("nav2_servers")

    def vehicle(self, robot: Robot) -> Vehicle:
        """The base with the shared costmap; it turns no head."""
        return Vehicle(
            self,
            robot,
            self.localization,
            self.planning_scene,
            self.nav2.config,
            shared=self.nav2.costmap,
            gazes=False,
        )


class Nav2Action(OnCostmap):
    """An action: it ends with `error_code_id` 0, or fails with a code and Nav2's number for it.

    numbers: Nav2's number of each failure code; other codes, such as SENSOR_DEAD, count as UNKNOWN.
    """

    server_name: str | None = In(None, ignored=True, doc="Nav2's action server")
    server_timeout: int | None = In(None, ignored=True, doc="ms that Nav2 waits for its server")
    error_code_id: int = Out(doc="Nav2's number of the failure, 0 for none", live=True)
    error_msg: str = Out(doc="the failure in words, empty for none", live=True)

    numbers: ClassVar[Mapping[str, int]] = {}

    def run(self, robot: Robot) -> Run:
        """Act; report the failure's number before failing."""
        self.error_code_id, self.error_msg = 0, ""
        try:
            yield from self.act(robot)
        except Failure as failure:
            code = failure.value.code
            self.error_code_id = self.numbers.get(code, self.numbers["UNKNOWN"])
            self.error_msg = failure.value.message
            raise

    def act(self, robot: Robot) -> Run:
        """What the action does; like `Skill.run`."""
        raise NotImplementedError(f"{type(self).__name__} has no act(self, robot)")
        yield ""


def known_name(given: str | None, valid: tuple[str, ...], what: str, code: str) -> None:
    """Check the name of a plug-in of Nav2; an empty one means the default.

    Raises:
        Failure: with `code`, when there is none of this name.
    """
    if given and given not in valid:
        raise Failure(code, f"there is no {what} {given!r}; there is {', '.join(valid)}")
