"""Grasp candidates for a measured shape, from many directions, in the object's frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import DetectedObject
from momantu_bt.robot import EndEffector
from momantu_skills.manipulation.hand.seating import Seat

AZIMUTHS = 24
"""Number of approach directions around an upright cylinder."""
TILTS = (0.0, math.radians(15), math.radians(30), math.radians(50))
"""Angles of the fingers below the horizontal, rad."""
HEIGHTS = (0.5, 0.62, 0.78)
"""Heights of the grasp, as shares of the object's height."""
LYING_HEIGHTS = (0.5, 0.38, 0.62)
"""The same of an object that lies."""
BOTTLE_HEIGHTS = (0.4, 0.3, 0.5)
"""The same of a bottle that lies: its body is heavier than its neck, and its shoulder slips out."""
TOP_TURNS = 12
"""Number of finger directions in a grasp from above."""
SLACK = 0.004
"""Clearance between palm and object, m: half of the detection error; beyond that the palm only
pushes."""
OUT = 0.006
"""Step by which a grasp is moved outwards until the open fingers clear the object, m."""
ROOM = 0.004
"""Clearance between open fingers and object, m: the detection error."""
TOUCH = 0.002
"""How deep fingers closed on an object may seem to be inside it, m: less than the detection error,
and what pads give."""
PAD_SHARE = 0.012
"""Length of the pads that must extend beyond the object's axis, m, so that they close on it; of
pads shorter than four times that a quarter of their length."""
FACE_SHARE = 0.035
"""Overlap of the pads with a box's flat faces that a grasp needs, m, wherever the axis is: flat
faces, unlike a cylinder's, do not slide out. More than half of a usual pad."""
BEYOND_PENALTY = 20.0
"""Cost, s per metre of the axis beyond the pads' middle: an object held there may swing."""
OPENING = 0.014
"""How much wider than the object the open gripper must be, m."""
TIGHT = 2 * ROOM
"""The same where no other grasp is left, m: the detection error on both sides."""
TIGHT_SHARE = 0.006
"""PAD_SHARE where no other grasp is left, m: more than the detection error."""
TOP_PENALTY = 3.0
"""Cost of a grasp from above, s: the object cannot be carried upright, and the hand hides it."""
TILT_PENALTY = 1.5
"""Cost per rad of tilt, s: the same disadvantages to a smaller extent."""
EDGE_PENALTY = 30.0
"""Cost per rad of tilt, s, where edges of the pads hold a cylinder: they touch it along a line
where it is upright between them, else at a point, about which it turns. 15 degrees cost 8 s."""
SWING_PENALTY = 150.0
"""Cost, s per metre, of holding an object above its middle: it swings when the hand turns, and what
hangs otherwise in the hand than it was grasped is set down leaning. A can of 13 cm that was held at
`HEIGHTS[2]`, 36 mm above its middle, turned by 23 degrees; at its middle none by more than 2. So a
hand rather leans while it holds the middle."""
RIM_WALL = 0.010
"""Assumed thickness of a wall between the pads, m: a bowl's is 3 to 8 mm and leans."""
THINNEST = 0.0025
"""Least opening at which a wall is between the pads, m: twice what a closed gripper may show."""
RIM_DEPTH = 0.035
"""Depth of the fingers' tips below a rim, m: more than half of a usual pad."""
THICK_WALL, LEANING = 0.008, math.radians(30)
"""Thickness, m, and lean, rad, of the thickest wall that is expected."""
THICKEST = THICK_WALL / math.cos(LEANING) + RIM_DEPTH * math.tan(LEANING)
"""Largest opening at which a wall is between the pads, m: 29 mm, with the wall along the tips."""
RIM_LEAST = 0.020
"""Least such depth for a firm hold, m."""
RIM_FLOOR = 0.025
"""Height of the fingers' tips above what the object stands on, m: its bottom, and room below."""
OVER_FLOOR = 0.008
"""Clearance between fingers and the surface that a lying object rests on, m: the hand's own (see
`HandConfig.near_margin`), and what a finger's hull is larger than the finger."""
DOWN = -math.sin(math.radians(20))
"""A lying object is taken by fingers that point at least this much down: others would have to come
through the surface, or lie on it."""
RIM_SHARES = (0.0, 0.5, -0.5)
"""Places along a side of a box, as shares of half the side."""


Part: TypeAlias = Literal["body", "rim", "handle"]
"""What of an object is between the pads."""


@dataclass(frozen=True, eq=False)
class Grasp:
    """One way to hold an object.

    object_from_grasp: the grasp frame's pose when the fingers close. width: between the pads then,
    m. penalty: cost in seconds; another grasp may take this much longer and still be preferred.
    part: what is between the pads. At a rim one finger is inside the object.
    """

    object_from_grasp: Transform
    width: float
    penalty: float
    part: Part = "body"

    @property
    def rim(self) -> bool:
        """Whether it holds the object by its rim."""
        return self.part == "rim"

    def fits(self, width: float, tolerance: float) -> bool:
        """Whether fingers that closed to `width` m may hold the object like this."""
        if self.part == "body":
            return abs(width - self.width) <= tolerance
        return THINNEST <= width <= THICKEST


class _Fingers(NamedTuple):
    """Planes around each finger, in the grasp frame: fully open, and closed on the object.

    seat: where along them a round object is held firmly; None for others. floor: what a lying
    object rests on.
    """

    open: Sequence[Array]
    closed: Sequence[Array]
    seat: Seat | None
    floor: Floor | None = None


@dataclass(frozen=True, eq=False)
class Floor:
    """The surface below a lying object, in the object's frame.

    up: its normal (3,). points: (n, 3) of it around the object, m.
    """

    up: Array
    points: Array


def grasps_for(
    thing: DetectedObject,
    hand: EndEffector,
    palm: Array,
    fingers: Sequence[Array] = (),
    tight: bool = False,
    closing: Callable[[float], Sequence[Array]] | None = None,
    floor: Floor | None = None,
) -> list[Grasp]:
    """All useful grasps, in a fixed order; those over its rim if the object is too wide for others.

    palm: corners (n, 3) of the hand's body in the grasp frame, m. fingers: planes (k, 4) around
    each open finger in the same frame, outward normal and offset. If the clearance near the
    knuckles is less than between the pads, the fingers hold the object farther out. tight: those
    too for which the open hand is hardly wider than the object, or its fingers hardly long enough.
    closing: gives the planes of the fingers at an opening. Fingers that turn meet a deep box's
    edges, or the rim of what they take from above, with their knuckles before their pads are
    closed, and jam; they hold it farther out too.
    Round things slide out from between knuckles: see `Seat`. floor: of a lying object, whose grasps
    are across its axis and keep the fingers above what it lies on.
    """
    opening, share = (TIGHT, TIGHT_SHARE) if tight else (OPENING, PAD_SHARE)
    found: list[Grasp] = []
    ways = approaches(thing) if floor is None else _across(thing, floor)
    fitting = [a for a in ways if a[0] <= hand.max_width - opening]
    is_box = thing.shape == "box"
    seat = None
    if fitting and closing is not None and not is_box:
        seat = Seat(hand, fitting[0][0] / 2, closing)
    for width, direction, top in fitting:
        meets = is_box or floor is not None or top  # knuckles may meet its edges before the pads
        closed = closing(width) if closing is not None and meets else ()
        both = _Fingers(fingers, closed, seat, floor)
        if top:
            found += _from_above(thing, hand, both, direction, width)
        else:
            farthest = _farthest(thing, hand, direction, share)
            found += _from_side(thing, hand, palm, both, direction, width, farthest)
    if not fitting and floor is None:
        return over_rim(thing, hand)
    return both_ways(found)


def over_rim(thing: DetectedObject, hand: EndEffector) -> list[Grasp]:
    """Grasps of an upright object by its rim; whether it is hollow is not known here."""
    return both_ways(_over_rim(thing, hand))


def both_ways(grasps: Iterable[Grasp]) -> list[Grasp]:
    """Each grasp, and the same with the hand turned by 180 degrees about its approach."""
    return [turned for grasp in grasps for turned in (grasp, _flipped(grasp))]


def approaches(thing: DetectedObject) -> Iterator[tuple[float, float, bool]]:
    """(width between pads in m, direction of the fingers in the object's xy plane, from above)."""
    if thing.shape == "cylinder":
        width = max(thing.size[0], thing.size[1])
        for i in range(AZIMUTHS):
            yield width, 2 * math.pi * i / AZIMUTHS, False
        for i in range(TOP_TURNS):
            yield width, math.pi * i / TOP_TURNS, True
        return
    for i in range(4):
        width = thing.size[1 if i % 2 == 0 else 0]
        yield width, i * math.pi / 2, False
        if i < 2:
            yield width, i * math.pi / 2, True


def _across(thing: DetectedObject, floor: Floor) -> Iterator[tuple[float, float, bool]]:
    """The same for an object that lies: straight down, and beside that as far as DOWN."""
    down = math.atan2(-float(floor.up[1]), -float(floor.up[0]))
    for off in range(-AZIMUTHS // 4, AZIMUTHS // 4 + 1):
        turn = 2 * math.pi * off / AZIMUTHS
        if -math.cos(turn) <= DOWN:
            yield max(thing.size[:2]), down + turn, False


def _from_side(
    thing: DetectedObject,
    hand: EndEffector,
    palm: Array,
    fingers: _Fingers,
    direction: float,
    width: float,
    farthest: float,
) -> Iterator[Grasp]:
    surface = surface_of(thing)
    shares = _shares(thing, fingers)
    for tilt, share in product(TILTS, shares):
        x = np.array(
            [
                math.cos(tilt) * math.cos(direction),
                math.cos(tilt) * math.sin(direction),
                -math.sin(tilt),
            ]
        )
        y = np.array([-math.sin(direction), math.cos(direction), 0.0])
        rotation = np.stack([x, y, np.cross(x, y)], axis=1)
        centre = np.array([0.0, 0.0, (share - 0.5) * thing.size[2]])
        local = (surface - centre) @ rotation
        back = _outwards(local, fingers, setback(local, hand, palm), farthest)
        if back is not None and fingers.floor is not None:
            back = _above(fingers, (fingers.floor.points - centre) @ rotation, back, farthest)
        if back is None:
            continue
        held = back if fingers.seat is None else fingers.seat.best(back, farthest)
        tilting = TILT_PENALTY if held == back else EDGE_PENALTY
        back = held
        penalty = tilting * tilt + SWING_PENALTY * abs(share - shares[0]) * thing.size[2]
        penalty += BEYOND_PENALTY * max(0.0, back - beyond_axis(hand))
        yield Grasp(Transform.from_rotation(rotation, centre - back * x), width, penalty)


def _shares(thing: DetectedObject, fingers: _Fingers) -> tuple[float, ...]:
    """Heights at which an object is held, as shares of its own, the best first."""
    if fingers.floor is None:
        return HEIGHTS
    return BOTTLE_HEIGHTS if thing.category == "bottle" else LYING_HEIGHTS


def _farthest(thing: DetectedObject, hand: EndEffector, direction: float, share: float) -> float:
    """Largest distance of the grasp frame behind the object's axis, m; share: see PAD_SHARE."""
    if thing.shape == "cylinder":
        return beyond_axis(hand, share)
    along = abs(math.cos(direction)) * thing.size[0] + abs(math.sin(direction)) * thing.size[1]
    return along / 2 + hand.pad_length / 2 - FACE_SHARE


def beyond_axis(hand: EndEffector, share: float = PAD_SHARE) -> float:
    """How far the middle of the pads may be behind a round thing's axis, m; see PAD_SHARE."""
    return hand.pad_length / 2 - min(share, hand.pad_length / 4)


def setback(local: Array, hand: EndEffector, palm: Array) -> float:
    """Distance of the grasp frame behind the object's axis at which the palm clears it, m.

    local: points (n, 3) of the object, in the grasp frame if that were on the axis.
    """
    reach_y, reach_z = np.abs(palm[:, 1]).max(), np.abs(palm[:, 2]).max()
    before = local[(np.abs(local[:, 1]) <= reach_y) & (np.abs(local[:, 2]) <= reach_z)]
    deepest = -float(before[:, 0].min()) if len(before) else 0.0
    return max(0.0, deepest - (hand.hand_clearance - SLACK))


def _outwards(local: Array, fingers: _Fingers, back: float, farthest: float) -> float | None:
    """`back`, or more if fingers would touch the object; None if open ones do up to `farthest`, m.

    Where closed ones do so everywhere, they hold the object as they can.
    """
    clear = clear_of(local, fingers.open, ROOM, back, farthest)
    if clear is None:
        return None
    closed = clear_of(local, fingers.closed, -TOUCH, clear, farthest)
    return clear if closed is None else closed


def _above(fingers: _Fingers, floor: Array, back: float, farthest: float) -> float | None:
    """`back`, or more until open and closed fingers clear the floor's points (n, 3), m."""
    for planes in (fingers.open, fingers.closed):
        clear = clear_of(floor, planes, OVER_FLOOR, back, farthest)
        if clear is None:
            return None
        back = clear
    return back


def clear_of(
    local: Array, fingers: Sequence[Array], room: float, back: float, farthest: float
) -> float | None:
    """The least distance from `back` to `farthest` at which fingers clear points by `room`, m."""
    while back <= farthest:
        moved = local + np.array((back, 0.0, 0.0))
        inside = (
            (moved @ planes[:, :3].T + planes[:, 3] < room).all(axis=1).any() for planes in fingers
        )
        if not any(inside):
            return back
        back += OUT
    return None


def _from_above(
    thing: DetectedObject,
    hand: EndEffector,
    fingers: _Fingers,
    direction: float,
    width: float,
) -> Iterator[Grasp]:
    x = np.array([0.0, 0.0, -1.0])
    y = np.array([-math.sin(direction), math.cos(direction), 0.0])
    rotation = np.stack([x, y, np.cross(x, y)], axis=1)
    deepest = min(hand.hand_clearance - SLACK, thing.size[2] / 2)
    centre = np.array([0.0, 0.0, thing.size[2] / 2 - deepest])
    back = _outwards((surface_of(thing) - centre) @ rotation, fingers, 0.0, deepest)
    if back is None:
        return
    centre[2] += back
    yield Grasp(Transform.from_rotation(rotation, centre), width, TOP_PENALTY)


def _over_rim(thing: DetectedObject, hand: EndEffector) -> Iterator[Grasp]:
    """One finger inside, one outside, the hand above."""
    overlap = min(RIM_DEPTH, thing.size[2] - RIM_FLOOR)
    if overlap < RIM_LEAST or overlap - hand.pad_length / 2 > hand.hand_clearance - SLACK:
        return
    height = (thing.size[2] + hand.pad_length) / 2 - overlap
    x = np.array([0.0, 0.0, -1.0])
    for (along, across), direction in _rim_places(thing):
        y = np.array([math.cos(direction), math.sin(direction), 0.0])
        rotation = np.stack([x, y, np.cross(x, y)], axis=1)
        place = np.array([along, across, height]) - RIM_WALL / 2 * y
        yield Grasp(Transform.from_rotation(rotation, place), RIM_WALL, TOP_PENALTY, "rim")


def _rim_places(thing: DetectedObject) -> Iterator[tuple[tuple[float, float], float]]:
    """Points (x, y) on the outline of an object's top, and the outward direction there, rad."""
    half = (thing.size[0] / 2, thing.size[1] / 2)
    if thing.shape == "cylinder":
        for i in range(AZIMUTHS):
            turn = 2 * math.pi * i / AZIMUTHS
            yield (max(half) * math.cos(turn), max(half) * math.sin(turn)), turn
        return
    for i, share in product(range(4), RIM_SHARES):
        c, s = round(math.cos(i * math.pi / 2)), round(math.sin(i * math.pi / 2))
        yield ((c - share * s) * half[0], (s + share * c) * half[1]), i * math.pi / 2


def _flipped(grasp: Grasp) -> Grasp:
    """The same grasp with the hand rotated by 180 degrees about its approach direction."""
    turn = Transform((0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0))
    return replace(grasp, object_from_grasp=grasp.object_from_grasp @ turn)


def surface_of(thing: DetectedObject) -> Array:
    """Points (n, 3) on the object's surface, about a centimetre apart, in its frame."""
    half = np.array(thing.size) / 2
    heights = np.linspace(-half[2], half[2], max(2, math.ceil(thing.size[2] / 0.01)))
    angles = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if thing.shape == "cylinder":
        ring = circle * max(half[0], half[1])
    else:
        ring = circle / np.abs(circle).max(axis=1, keepdims=True) * half[:2]
    return np.vstack([np.column_stack([ring, np.full(len(ring), z)]) for z in heights])
