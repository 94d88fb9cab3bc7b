"""From an SDF file to a world file and its assets."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from momantu_bt.formats.files import write_whole
from momantu_bt.formats.places import Place
from momantu_bt.geometry import Pose2D, Transform
from momantu_worlds.scenes.file.reader import parse_world
from momantu_worlds.sdf.body.bodies import BodyMaker, ImportedBody, plain_name
from momantu_worlds.sdf.body.flush_tops import flush
from momantu_worlds.sdf.body.frames import PlacedModel
from momantu_worlds.sdf.body.ground import find_ground
from momantu_worlds.sdf.body.lighting import lighting
from momantu_worlds.sdf.body.placing import placed_lights, placed_models
from momantu_worlds.sdf.body.rigid_groups import is_robot, rigid_groups
from momantu_worlds.sdf.body.settling import settled
from momantu_worlds.sdf.body.shaping import Shaping
from momantu_worlds.sdf.body.wedged import held_where_wedged
from momantu_worlds.sdf.deviations import LOST, Deviations, Outcome
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.mesh.assets import Assets
from momantu_worlds.sdf.read.uris import search_folders
from momantu_worlds.sdf.read.world import read_world
from momantu_worlds.sdf.write.proposal import propose
from momantu_worlds.sdf.write.task import Wanted, with_task
from momantu_worlds.sdf.write.writing import Imported, world_text

NOTHING = Wanted()
MOST_BODIES = 2000
"""Most bodies in a world file."""
TIGHT = 0.25
"""Half the edge of a square that is too small for most robots, m."""
MOST_SAID = 10
"""Most left-out elements that an error message lists."""


@dataclass(frozen=True, slots=True)
class Import:
    """The result of an import. text: of the world file; assets: the other files."""

    world: Imported
    text: str
    assets: Assets
    deviations: Deviations

    def write(self, output: Path) -> int:
        """Write the assets, then the world file; returns how many assets there are.

        Raises:
            OutputError: they cannot be written.
        """
        count = self.assets.write(output)
        parse_world(self.text, output)  # a file that the reader refuses is not left behind
        write_whole(output, self.text)
        return count


def import_world(
    file: Path,
    output: Path,
    models: Iterable[Path] = (),
    *,
    heed_up: bool = False,
    wanted: Wanted = NOTHING,
) -> Import:
    """Turn an SDF world into a world file; nothing is written yet.

    Args:
        file: a `.world` or `.sdf` file.
        output: where the world file will lie; its assets lie beside it.
        models: folders in which `model://` is looked up, before Gazebo's own and the file's.
        heed_up: turn COLLADA upright by its <up_axis>, which Gazebo does not.
        wanted: what is to be brought, and where.

    Raises:
        InputError: what is wanted is not there.
        SdfError: the file itself is broken, or nothing could be imported.
    """
    deviations = Deviations()
    for folder in (folder for folder in models if not folder.is_dir()):
        raise SdfError(Place(str(file)), f"--models {folder}: there is no such folder")
    source = read_world(file, search_folders(file, models, os.environ), deviations)
    placed = placed_models(source, deviations)
    robot = next((model for model in placed if is_robot(model)), None)
    things = [model for model in placed if model is not robot]
    assets = Assets(f"{plain_name(output.stem)}_assets")
    shaping = Shaping(assets, deviations, heed_up)
    ground = find_ground(things, shaping.faces, deviations)
    maker = BodyMaker(shaping, ground, deviations)
    made = [
        body
        for model in things
        for group in rigid_groups(model, deviations)
        for body in maker.body(model, group)
    ]
    standing = held_where_wedged(list(settled(made, ground.height, deviations)), deviations)
    bodies = _enough(standing, deviations)
    if not bodies and (deviations.models_lost or not ground.shapes):
        raise SdfError(Place(str(file)), _nothing_left(deviations))
    light = lighting(
        placed_lights(source, placed, deviations), source.ambient, ground.height, deviations
    )
    name, model = plain_name(output.stem), robot.model.name if robot else None
    site = propose(bodies, _start_of(robot, deviations))
    tops = {name: surface.top for name, surface in site.surfaces.items()}
    bodies, task = with_task(list(flush(bodies, tops, deviations)), site.surfaces, wanted)
    if task.sizes is not None:
        site = replace(site, objects={**site.objects, task.item: task.sizes})
    if site.clear < TIGHT:
        near = f"{site.clear:.2f} m around the start"
        deviations.changed(
            Place(str(file)), "world", near, "no robot turns there; write another start"
        )
    world = Imported(name, file.name, model, bodies, ground, light, site, task=task)
    return Import(world, world_text(world, deviations), assets, deviations)


def _start_of(robot: PlacedModel | None, deviations: Deviations) -> Pose2D | None:
    """The start pose of a robot of the SDF world."""
    if robot is None:
        return None
    pose = _base(robot)
    deviations.changed(
        robot.model.place,
        robot.model.name,
        "a robot: its joints move, and it has sensors or plugins",
        "its place is the start; which robot runs is said by --robot",
    )
    return Pose2D.from_transform(pose)


def _base(robot: PlacedModel) -> Transform:
    """The model's own frame, unless a saved state moved its first link away from it."""
    if not robot.links:
        return robot.world_from_model
    first = robot.links[0]
    back = robot.scope.pose(first.link.name, first.link.place).inverse()
    return first.world_from_link @ back


def _nothing_left(deviations: Deviations) -> str:
    """Why there is nothing to write: whole models that were lost first."""
    gone = [deviation for deviation in deviations if deviation.outcome is Outcome.DROPPED]
    gone.sort(key=lambda deviation: deviation.instead != LOST)
    why = "".join(f"\n  {f.place}: {f.subject}: {f.what}" for f in gone[:MOST_SAID])
    return f"nothing is left of this world{': what it has is left out' + why if why else ''}"


def _enough(bodies: list[ImportedBody], deviations: Deviations) -> list[ImportedBody]:
    for body in bodies[MOST_BODIES:]:
        what = f"a body beyond the first {MOST_BODIES}"
        deviations.dropped(body.place, body.title, what, "left out")
    return bodies[:MOST_BODIES]
