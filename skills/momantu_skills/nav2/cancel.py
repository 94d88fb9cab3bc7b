"""CancelControl and its kin: end an action of Nav2 wherever in the tree it runs."""

from __future__ import annotations

from typing import ClassVar

from momantu_bt.robot import Robot
from momantu_bt.skill import In, Needs, Run, Skill
from momantu_skills.nav2.service import Nav2Service


class _Cancel(Skill):
    """Ends an action; the leaf that runs it succeeds, as in Nav2."""

    action: ClassVar[str] = ""

    server_name: str | None = In(None, ignored=True, doc="Nav2's action server")
    server_timeout: int | None = In(None, ignored=True, doc="ms that Nav2 waits for its server")

    nav2: Nav2Service = Needs("nav2_servers")

    def run(self, robot: Robot) -> Run:
        """Cancel, at once."""
        self.nav2.cancel(self.action)
        return
        yield ""


class CancelControl(_Cancel):
    """End FollowPath wherever it runs: the base stops, and FollowPath succeeds."""

    action = "FollowPath"


class CancelSpin(_Cancel):
    """End Spin wherever it runs."""

    action = "Spin"


class CancelBackUp(_Cancel):
    """End BackUp wherever it runs."""

    action = "BackUp"


class CancelDriveOnHeading(_Cancel):
    """End DriveOnHeading wherever it runs."""

    action = "DriveOnHeading"


class CancelWait(_Cancel):
    """End Wait wherever it runs."""

    action = "Wait"
