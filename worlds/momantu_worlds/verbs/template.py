"""The text of a small world: two rooms, a door, two tables, a can, a tag."""

from __future__ import annotations

import re
from pathlib import Path

from momantu_bt.errors import MomantuError

LEAST, MOST = (6.0, 4.0), (40.0, 40.0)
"""m; extents along x and y between which the furniture fits and a robot finds its way."""
_SIZE = re.compile(r"(\d+(?:\.\d+)?)\s*[xX×]\s*(\d+(?:\.\d+)?)")
_NAME = re.compile(r"[a-z][a-z0-9_]{0,59}")


class CannotMake(MomantuError):
    """The arguments describe no possible world; the message says what would be valid."""


def two_rooms(file: Path, size: str, schema: Path | None) -> str:
    """The text of a world file, its name that of the file.

    size: `WxD`, m. schema: what an editor completes it by.

    Raises:
        CannotMake: the size is invalid, too small or too large, or the file's name is invalid.
    """
    width, depth = _extent(size)
    if file.suffix not in (".yaml", ".yml"):
        raise CannotMake(f"{file} is not a .yaml file; worlds are YAML")
    if not _NAME.fullmatch(file.stem):
        raise CannotMake(
            f"{file.stem!r} is not a name for a world: lower-case letters, digits and underscores, "
            "a letter first"
        )
    head = "" if schema is None else f"# yaml-language-server: $schema={schema}\n"
    return head + _filled(file.stem, width, depth)


def _extent(size: str) -> tuple[float, float]:
    match = _SIZE.fullmatch(size.strip())
    if match is None:
        raise CannotMake(f"{size!r} is not a size; write 8x5 for 8 m along x and 5 m along y")
    width, depth = float(match[1]), float(match[2])
    if not (LEAST[0] <= width <= MOST[0] and LEAST[1] <= depth <= MOST[1]):
        raise CannotMake(
            f"--size {size}: between {LEAST[0]:g}x{LEAST[1]:g} and {MOST[0]:g}x{MOST[1]:g} m"
        )
    return width, depth


def _filled(name: str, width: float, depth: float) -> str:
    """The template with every place computed from the extents, m."""
    x, y = width / 2, depth / 2
    lengths = {
        "west": -x,
        "south": -y,
        "half": x,
        "depth": depth,
        "a_x": x - 0.60,
        "a_y": y - 1.10,
        "b_x": -x + 0.60,
        "b_y": y - 1.20,
        "middle_west": -x / 2,
        "middle_east": x / 2,
        "start_x": -x / 2,
        "start_y": -y + 1.30,
        "shelf_x": x - 1.0,
        "shelf_y": -y + 0.25,
        "sofa_x": -x + 0.55,
        "sofa_y": -y + 1.10,
        "plant_x": 0.40,
        "plant_y": -y + 0.40,
        "lamp": 0.0,
    }
    values = {key: f"{round(value, 2) + 0.0:.2f}" for key, value in lengths.items()}
    return TEXT.format(name=name, **values)


TEXT = """\
# Two rooms with a door between them; a can on a desk in one, a tag on a low table in the other.
# Bare numbers are metres, radians and kilograms; units may be written: 5 cm, 90 deg, 400 g.
# Poses are [x, y, yaw] in the map's frame. Furniture shows its front to its own +x;
# sizes are [depth along x, width along y, height].
#
#   momantu-bt worlds check FILE            what is wrong with it, for a robot
#   momantu-bt worlds preview FILE -o PNG   what it looks like
#   momantu-bt run bring_object --world FILE

momantu_world: 1
name: {name}

# Walls follow from rooms and doors; an outline runs along the middles of its walls.
walls: {{thickness: 12 cm, height: 2.5 m}}
rooms:
  west: {{corner: [{west}, {south}], size: [{half}, {depth}]}}
  east: {{corner: [0.00, {south}], size: [{half}, {depth}]}}
doors:
  door: {{at: [0.00, 0.00], width: 1.1 m}}

# Tops that a tree can name. `shift`, `turn` and `lift` say how far an episode may move them;
# `sides` are where to stand, preferred first, seen in the table's own frame.
tables:
  table_a:
    kind: desk
    at: [{a_x}, {a_y}, 0 deg]
    size: [0.80, 1.40, 0.72]
    shift: 5 cm
    turn: 3 deg
    lift: 2 cm
    sides: [180 deg, -90 deg]
  table_b:
    kind: table
    at: [{b_x}, {b_y}, 0 deg]
    size: [0.80, 1.20, 0.50]
    color: [0.45, 0.33, 0.24]
    shift: 5 cm
    turn: 3 deg
    lift: 2 cm
    sides: [0 deg, -90 deg]

# What is brought, and the tag (AprilTag, family 36h11) beside which it goes. `at` is where they
# are on their tables, in the table's own frame.
item:
  name: can
  kind: can
  on: table_a
  at: [-0.20, 0.00]
  shift: 10 cm
  radius: 35 mm
  height: 130 mm
  mass: 0.4 kg
  friction: 0.9
  color: [0.78, 0.14, 0.12]
tag:
  name: tag
  id: 1
  edge: 150 mm
  on: table_b
  at: [0.10, 0.00]
  shift: 10 cm

# Other loose things on the tables, 0 to `most` on each.
distractors: {{most: 2, kinds: [bottle, box, mug, bowl]}}

# Kinds: table desk counter chair sofa bed shelf crate pallet cabinet plant figure.
# `moves`: an episode may move it, as `unknown` says.
furniture:
  sofa: {{kind: sofa, at: [{sofa_x}, {sofa_y}, 0 deg], size: [0.85, 1.60, 0.80]}}
  shelf: {{kind: shelf, at: [{shelf_x}, {shelf_y}, 90 deg], size: [0.35, 1.20, 1.80]}}
  plant: {{kind: plant, at: [{plant_x}, {plant_y}, 0 deg], size: [0.40, 0.40, 1.20], moves: true}}

# Where the robot stands at first, how far an episode shifts that, and how wrong it is told.
start:
  at: [{start_x}, {start_y}, 0 deg]
  shift: 20 cm
  belief_shift: 20 cm
  belief_turn: 10 deg

# What the map does not know: so many of the pieces that may move stand elsewhere.
unknown:
  shift: 10 cm
  turn: 15 deg
  moved: {{least: 0, most: 1}}

light:
  lamps: [[{middle_west}, {lamp}], [{middle_east}, {lamp}]]

# What the referee wants at the end.
goal:
  item: can
  on: table_b
  beside: tag
  distance: 0.4 m

# What the robot is told, beside the tables, the map and its rough start.
site:
  places:
    home: [{start_x}, {start_y}, 0 deg]
    west_room: [{middle_west}, {lamp}, 0 deg]
    east_room: [{middle_east}, {lamp}, 180 deg]
  objects:
    can: {{category: can, diameter: 70 mm, height: 130 mm}}
"""
