"""Arranging the floor of an episode: tables, furniture, the robot's start.

Every pose is drawn from the seed and kept only if the robot can still do its task: doorways and the
tables' preferred sides stay free, and a disc of the world's `passage` radius can still move from
the start to all tables and through every doorway. A world that names no radius keeps the widest of
`RADII` that its file leaves.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from momantu_bt.geometry import Pose2D
from momantu_bt.world import WorldError, seeded
from momantu_worlds.scenes.arrange.layout import PlacedPiece, PlacedTable
from momantu_worlds.scenes.arrange.obstacles import fixed_rectangles, floor_extent, footprint
from momantu_worlds.scenes.arrange.surfaces import board_surface, carriers, nominal_surfaces
from momantu_worlds.scenes.file.furniture import Piece
from momantu_worlds.scenes.file.variation import Unknown
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.plane import Rectangle, clear_of, passages

TRIES = 60
"""Draws for one piece before it is left out (an extra) or stays at its place on the map."""
MOVED_GAP = 0.03
"""Least distance of a moved piece from everything else, m."""
EXTRA_GAP = 0.15
"""Least distance of an extra piece from everything else, m."""
STAND_OFF = 0.55
"""Distance from a table's edge to the base of a robot that reaches onto it, m."""
RADII = (0.4, 0.35, 0.3, 0.25, 0.2)
"""Radii of discs, m, that are tried where a world names none; robots are wider than the last."""
WIDE = 0.4
"""Disc radius above which a coarse grid is enough, m, as such discs need wide doors."""
COARSE, FINE = 0.1, 0.05
"""Cell sizes of the grid of passages, m. In a narrow door a disc's centre has a range of a few
cm."""
SIDEWAYS = 0.3
"""Extra width of the zone before a table that is kept free, m, on either side."""
UNVARIED = Unknown()
"""Default without a section `unknown`: nothing is moved or added."""


def place_tables(
    world: WorldFile, seed: int
) -> tuple[dict[str, PlacedTable], dict[str, PlacedPiece]]:
    """Draw the poses of surfaces, and of the shelves whose boards are surfaces."""
    shelves = {name: _shelf(world, seed, name) for name in carriers(world)}
    placed = {}
    for name, nominal in nominal_surfaces(world).items():
        table = world.tables.get(name)
        if table is None:
            placed[name] = nominal
        elif table.board_of is not None:
            shelf = shelves[table.board_of]
            placed[name] = board_surface(shelf.piece, table, shelf.pose)
        else:
            draw = seeded(seed, "table", name)
            pose = _shifted(draw, nominal.pose, table.shift, table.turn)
            lift = float(draw.uniform(-table.lift, table.lift))
            placed[name] = replace(nominal, pose=pose, height=nominal.height + lift)
    return placed, shelves


def _shelf(world: WorldFile, seed: int, name: str) -> PlacedPiece:
    piece = world.furniture[name]
    draw = seeded(seed, "table", name)
    return PlacedPiece(name, piece, _shifted(draw, piece.pose, piece.shift, piece.turn), True)


def _shifted(draw: np.random.Generator, pose: Pose2D, shift: float, turn: float) -> Pose2D:
    x, y = draw.uniform(-shift, shift, 2)
    yaw = float(draw.uniform(-turn, turn))
    return Pose2D(pose.x + float(x), pose.y + float(y), pose.yaw + yaw)


def place_start(world: WorldFile, seed: int) -> tuple[Pose2D, Pose2D]:
    """Draw the true start pose, and the start pose that the robot is given."""
    draw = seeded(seed, "start")
    nominal = Pose2D(*world.start.at)
    fixed = [*fixed_rectangles(world)]
    fixed += [footprint(world, p, p.pose) for p in world.furniture.values()]
    fixed += [Rectangle(t.pose, t.size) for t in nominal_surfaces(world).values()]
    turn = world.start.turn
    for _ in range(TRIES):
        x, y = draw.uniform(-world.start.shift, world.start.shift, 2)
        yaw = float(draw.uniform(-math.pi, math.pi))
        if turn is not None:
            yaw = nominal.yaw + turn * yaw / math.pi
        start = Pose2D(nominal.x + float(x), nominal.y + float(y), yaw)
        if clear_of(around(start, world.start.clear), fixed, 0.0):
            break
    else:
        raise WorldError(
            f"the world {world.name!r} has no free place to start within {world.start.shift:g} m "
            f"of ({nominal.x:g}, {nominal.y:g}), where {world.start.clear:g} m around it are free; "
            "move start.at, or make start.clear smaller"
        )
    away = float(draw.uniform(0.0, world.start.belief_shift))
    where = float(draw.uniform(-math.pi, math.pi))
    off = float(draw.uniform(-world.start.belief_turn, world.start.belief_turn))
    x, y = start.x + away * math.cos(where), start.y + away * math.sin(where)
    return start, Pose2D(x, y, start.yaw + off)


def place_furniture(
    world: WorldFile,
    seed: int,
    tables: Mapping[str, PlacedTable],
    shelves: Mapping[str, PlacedPiece],
    start: Pose2D,
) -> tuple[PlacedPiece, ...]:
    """Known furniture, some of it moved, and extra pieces. shelves: those that are placed already.

    Raises:
        WorldError: the robot could not do its task even if nothing was moved or added.
    """
    known = {name: PlacedPiece(name, p, p.pose, True) for name, p in world.furniture.items()}
    known |= shelves
    room = _Room(world, tables, known, start)
    placed = dict(known)
    for change in (*_own_shifts(world, seed), *_moves(world, seed), *_extras(world, seed)):
        for piece in change:
            others = [room.footprint(p) for n, p in placed.items() if n != piece.name]
            then = {**placed, piece.name: piece}
            if room.fits(piece, others) and room.passable(then.values()):
                placed = then
                break
    if world.unknown is not None and placed == known:
        _promise(world.name, room, known)
    return tuple(placed.values())


def _promise(name: str, room: _Room, known: Mapping[str, PlacedPiece]) -> None:
    """Refuse a world whose file leaves too little room for the disc that it promises."""
    missed = room.missed(known.values())
    if not missed:
        return
    wider = next((r for r in RADII if r < room.passage and not room.missed(known.values(), r)), 0.0)
    cure = "move what stands in the way"
    without = {n: [p for other, p in known.items() if other != n] for n in known}
    guilty = [n for n, others in without.items() if len(room.missed(others)) < len(missed)]
    if guilty:
        cure += f": {', '.join(guilty)}"
    if wider:
        cure = f"write passage: {100 * wider:.0f} cm in `unknown`, or {cure}"
    raise WorldError(
        f"in the world {name!r} a disc of {room.passage:g} m radius does not get from the start "
        f"{', '.join(missed)}; {cure}"
    )


def _own_shifts(world: WorldFile, seed: int) -> Iterator[Iterator[PlacedPiece]]:
    """Random shifts of the pieces that shift in every episode."""
    shelves = carriers(world)
    for name, piece in world.furniture.items():
        if (piece.shift or piece.turn) and name not in shelves:
            draw = seeded(seed, "shifted", name)
            yield _elsewhere(name, piece, draw, piece.shift, piece.turn)


def _moves(world: WorldFile, seed: int) -> Iterator[Iterator[PlacedPiece]]:
    unknown = world.unknown or UNVARIED
    draw = seeded(seed, "moved")
    names = [name for name, piece in world.furniture.items() if piece.moves]
    wanted = int(draw.integers(unknown.moved.least, unknown.moved.most + 1))
    for name in draw.permutation(names)[:wanted].tolist():
        own = seeded(seed, "moved", name)
        yield _elsewhere(name, world.furniture[name], own, unknown.shift, unknown.turn)


def _elsewhere(
    name: str, piece: Piece, draw: np.random.Generator, shift: float, turn: float
) -> Iterator[PlacedPiece]:
    """Draw poses where a piece may stand."""
    for _ in range(TRIES):
        yield PlacedPiece(name, piece, _shifted(draw, piece.pose, shift, turn), True)


def _extras(world: WorldFile, seed: int) -> Iterator[Iterator[PlacedPiece]]:
    unknown = world.unknown or UNVARIED
    wanted = int(seeded(seed, "extra").integers(unknown.extra.least, unknown.extra.most + 1))
    for i in range(wanted if unknown.areas else 0):
        yield _anywhere(unknown, seed, i)


def _anywhere(unknown: Unknown, seed: int, number: int) -> Iterator[PlacedPiece]:
    draw = seeded(seed, "extra", number)
    kind = unknown.kinds[int(draw.integers(len(unknown.kinds)))]
    for _ in range(TRIES):
        x0, y0, x1, y1 = unknown.areas[int(draw.integers(len(unknown.areas)))]
        x, y = float(draw.uniform(x0, x1)), float(draw.uniform(y0, y1))
        pose = Pose2D(x, y, float(draw.uniform(-math.pi, math.pi)))
        piece = Piece(kind=kind, at=(pose.x, pose.y, pose.yaw))
        yield PlacedPiece(f"extra_{kind}_{number}", piece, pose, False)


class _Room:
    """The floor that furniture must leave free: doorways, the start, before tables, passages.

    passage: radius of the disc that gets everywhere, m.
    """

    def __init__(
        self,
        world: WorldFile,
        tables: Mapping[str, PlacedTable],
        known: Mapping[str, PlacedPiece],
        start: Pose2D,
    ) -> None:
        unknown = world.unknown or UNVARIED
        self._world = world
        self._standing, self._floor = fixed_rectangles(world), floor_extent(world)
        self._tops = [Rectangle(table.pose, table.size) for table in tables.values()]
        doors = world.all_doorways
        self._doors = [(np.array(door.at), door.clear) for door in doors.values()]
        self._zones = [around(start, world.start.clear)]
        self._zones += [stand_zone(table, unknown.stand) for table in tables.values()]
        stands = {name: stand_pose(table) for name, table in tables.items()}
        self._start = (start.x, start.y)
        self._stops = {f"through the doorway {name!r}": door.at for name, door in doors.items()}
        self._stops |= {f"to the front of {name!r}": (at.x, at.y) for name, at in stands.items()}
        self.passage = unknown.passage or self._widest(known)

    def _widest(self, known: Mapping[str, PlacedPiece]) -> float:
        """The widest disc that gets everywhere as the file stands; the smallest if none does."""
        fit = (r for r in RADII if not self.missed(known.values(), r))
        return next(fit, RADII[-1])

    def footprint(self, placed: PlacedPiece) -> Rectangle:
        """The floor area under a piece."""
        return footprint(self._world, placed.piece, placed.pose)

    def fits(self, placed: PlacedPiece, others: list[Rectangle]) -> bool:
        """Whether a piece keeps the required distances."""
        own = self.footprint(placed)
        least = MOVED_GAP if placed.known else EXTRA_GAP
        return (
            clear_of(own, self._zones, 0.0 if placed.known else EXTRA_GAP)
            and all(float(own.distance(at)) >= radius for at, radius in self._doors)
            and clear_of(own, self._standing, least)
            and clear_of(own, self._tops, least)
            and clear_of(own, others, least)
        )

    def passable(self, pieces: Iterable[PlacedPiece]) -> bool:
        """Whether the disc can still move from the start to all targets."""
        return not self.missed(pieces)

    def missed(self, pieces: Iterable[PlacedPiece], radius: float | None = None) -> list[str]:
        """The targets that a disc, by default that of `passage`, does not reach from the start."""
        obstacles = [*self._standing, *map(self.footprint, pieces), *self._tops]
        wide = self.passage if radius is None else radius
        center, size = self._floor
        grid = passages(obstacles, center, size, wide, COARSE if wide >= WIDE else FINE)
        reached = grid.reachable(self._start)
        return [name for name, at in self._stops.items() if not reached[grid.index(at)]]


def around(pose: Pose2D, radius: float) -> Rectangle:
    """A square around a pose, with half edge `radius` m."""
    return Rectangle(pose, (2 * radius, 2 * radius))


def side_pose(placed: PlacedTable, side: int, away: float) -> Pose2D:
    """A pose `away` m before the middle of a side's edge, facing the table."""
    angle = placed.sides[side]
    half_x, half_y = placed.size[0] / 2, placed.size[1] / 2
    along = half_x if abs(math.cos(angle)) > abs(math.sin(angle)) else half_y
    reach = along + away
    own = Pose2D(reach * math.cos(angle), reach * math.sin(angle), angle + math.pi)
    return placed.pose @ own


def stand_pose(placed: PlacedTable) -> Pose2D:
    """Pose of a robot before the middle of the preferred side."""
    return side_pose(placed, 0, STAND_OFF)


def stand_zone(placed: PlacedTable, depth: float) -> Rectangle:
    """The floor before the preferred side that is kept free."""
    along_x = abs(math.cos(placed.sides[0])) > abs(math.sin(placed.sides[0]))
    width = placed.size[1] if along_x else placed.size[0]
    return Rectangle(side_pose(placed, 0, depth / 2), (depth, width + 2 * SIDEWAYS))
