"""ReinitializeGlobalLocalization: forget where the robot is."""

from __future__ import annotations

from typing import ClassVar

from momantu_bt.activity import Activity
from momantu_bt.robot import Robot
from momantu_bt.service import Localization
from momantu_bt.skill import In, Needs, Run, Skill


class ReinitializeGlobalLocalization(Skill):
    """Spread the guesses of where the robot is over the whole map.

    As in Nav2, the robot knows its place again only after it has moved: turn it with `Spin`. The
    skill `relocalize` does both, and checks the result.
    """

    service_name: str | None = In(None, ignored=True, doc="Nav2's service")
    server_timeout: int | None = In(None, ignored=True, doc="ms that Nav2 waits for the service")

    localization: Localization = Needs()
    activities: ClassVar = {Activity.LOCALIZE: ""}

    def run(self, robot: Robot) -> Run:
        """Spread them, at once."""
        self.localization.spread()
        return
        yield ""
