"""momantu-bt: program a mobile manipulator by editing one tree file.

What a plug-in author imports, and `run(tree, world=…, seed=…) -> Report`. Names are looked up
when they are first used, so that importing the package costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from momantu_bt.version import __version__

if TYPE_CHECKING:
    from momantu_bt.failure import Failure
    from momantu_bt.geometry import Pose, Pose2D, Transform
    from momantu_bt.py_trees_bridge.mount import as_behaviour
    from momantu_bt.record.report import Report
    from momantu_bt.robot import CAMERA_CARRIER, Robot
    from momantu_bt.running.api import run
    from momantu_bt.service import Service, ServiceContext
    from momantu_bt.session import Session, open_session
    from momantu_bt.skill import In, Needs, Out, Run, Skill, compute
    from momantu_bt.world import Site, World


_HOMES = {
    "CAMERA_CARRIER": "robot",
    "Failure": "failure",
    "In": "skill",
    "Needs": "skill",
    "Out": "skill",
    "Pose": "geometry",
    "Pose2D": "geometry",
    "Report": "record.report",
    "Robot": "robot",
    "Run": "skill",
    "Service": "service",
    "ServiceContext": "service",
    "Site": "world",
    "Session": "session",
    "Skill": "skill",
    "Transform": "geometry",
    "World": "world",
    "as_behaviour": "py_trees_bridge.mount",
    "compute": "skill",
    "open_session": "session",
    "run": "running.api",
}

__all__ = [
    "CAMERA_CARRIER",
    "Failure",
    "In",
    "Needs",
    "Out",
    "Pose",
    "Pose2D",
    "Report",
    "Robot",
    "Run",
    "Service",
    "ServiceContext",
    "Session",
    "Site",
    "Skill",
    "Transform",
    "World",
    "__version__",
    "as_behaviour",
    "compute",
    "open_session",
    "run",
]


def __dir__() -> list[str]:
    """The public names, for completion in a shell."""
    return sorted(__all__)


def __getattr__(name: str) -> Any:
    """A public name, imported from the module that defines it."""
    if name not in _HOMES:
        raise AttributeError(f"momantu_bt has no {name!r}; it has: {', '.join(__all__)}")
    if name in ("run", "open_session"):
        import_module("momantu_bt.threads")  # before numpy, which the next import loads
    return getattr(import_module(f"momantu_bt.{_HOMES[name]}"), name)
