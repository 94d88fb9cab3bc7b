"""Reading a robot's folder: `robot.yaml` and `simulation.yaml`."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from momantu_bt.robot import RobotDescription
from momantu_bt.world import WorldError


class BaseJoints(BaseModel):
    """The URDF's virtual joints that carry the base: two slides and a hinge."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    x: str
    y: str
    yaw: str


class Cuts(BaseModel):
    """Where a mesh is cut by planes across x, y and z of its own frame, m."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    x: tuple[float, ...] = ()
    y: tuple[float, ...] = ()
    z: tuple[float, ...] = ()


class SimulationModel(BaseModel):
    """What a simulator must know of a robot beyond its description.

    base_force (N), base_torque (Nm): the most that the wheels can push. floor_links: links that
    are not checked against the floor. finger_friction: of the pads, at most 2. convex_cells:
    links whose collision mesh is cut, each cell becoming a convex hull; others are one hull.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    base_joints: BaseJoints
    base_force: float
    base_torque: float
    floor_links: tuple[str, ...]
    no_collision_links: tuple[str, ...]
    finger_links: tuple[str, ...]
    finger_friction: float
    convex_cells: dict[str, Cuts] = {}


def read_description(folder: Path) -> RobotDescription:
    """The description in `folder/robot.yaml`, its URDF found in the installed package it names.

    Raises:
        WorldError: the file is wrong, or the package with the URDF is not installed.
    """
    data = _read(folder / "robot.yaml")
    urdf = _asset(data.pop("urdf"), folder / "robot.yaml")
    data["urdf"] = urdf
    data["mesh_directories"] = (urdf.parent,)
    try:
        return RobotDescription.model_validate(data)
    except ValidationError as error:
        raise WorldError(f"{folder / 'robot.yaml'}: {error}") from None


def read_simulation(name: str) -> SimulationModel:
    """The simulation model of one of this package's robots.

    Raises:
        WorldError: this package has no robot of that name that can be simulated.
    """
    folder = Path(__file__).parent
    path = folder / name / "simulation.yaml"
    if not path.is_file():
        known = sorted(p.parent.name for p in folder.glob("*/simulation.yaml"))
        raise WorldError(
            f"the robot {name!r} cannot be simulated here: it has no simulation.yaml; "
            f"robots that can be: {', '.join(known)}"
        )
    try:
        return SimulationModel.model_validate(_read(path))
    except ValidationError as error:
        raise WorldError(f"{path}: {error}") from None


def _read(path: Path) -> dict[str, Any]:
    try:
        data: dict[str, Any] = YAML(typ="safe", pure=True).load(path.read_text())
    except (OSError, YAMLError) as error:
        raise WorldError(f"the robot file {path} cannot be read: {error}") from None
    return data


def _asset(where: dict[str, str], path: Path) -> Path:
    """Locate a file inside an installed package without importing that package."""
    package, file = where["package"], where["file"]
    spec = importlib.util.find_spec(package)
    if spec is None or not spec.submodule_search_locations:
        raise WorldError(
            f"{path.parent.name} needs the files of the Python package {package!r}, which is not "
            "installed; run `make setup`, or `pip install 'momantu-bt[all]'`"
        )
    found = Path(next(iter(spec.submodule_search_locations))) / file
    if not found.is_file():
        raise WorldError(
            f"the Python package {package!r} is installed but has no {file}; "
            "reinstall the version that constraints.txt names"
        )
    return found
