"""The kinds of states: what is done with a hand that is open and empty."""

from __future__ import annotations

import math
from collections.abc import Callable

from momantu_worlds.scenes.geometry.solids import PlacedBody

from holding.hand import Hand
from momantu_bt.geometry import Transform


def _turned(axis: str, angle: float) -> Transform:
    half, place = angle / 2, "xyz".index(axis)
    quaternion = [math.cos(half), 0.0, 0.0, 0.0]
    quaternion[1 + place] = math.sin(half)
    return Transform((0, 0, 0), tuple(quaternion))


def held(hand: Hand) -> None:
    hand.grasp(
        "can", Transform((hand.random.uniform(-0.01, 0.015), 0, hand.random.uniform(-0.04, 0.04)))
    )


def tilted(hand: Hand) -> None:
    sign = hand.random.choice([-1, 1])
    hand.grasp("can", _turned("y", sign * math.radians(hand.random.uniform(10, 85))))


def leaning_across(hand: Hand) -> None:
    sign = hand.random.choice([-1, 1])
    hand.grasp("can", _turned("x", sign * math.radians(hand.random.uniform(10, 85))))


def by_its_edge(hand: Hand) -> None:
    side = hand.random.choice([-1, 1])
    hand.grasp("can", Transform((0.0, 0.0, side * hand.random.uniform(0.055, 0.072))))


def slipped_half_out(hand: Hand) -> None:
    hand.grasp("can", Transform((hand.random.uniform(0.02, 0.06), 0.0, 0.0)))


def against_the_palm(hand: Hand) -> None:
    back = -hand.random.uniform(0.015, 0.05)
    side = hand.random.choice([-1, 1]) * hand.random.uniform(0.005, 0.02)
    hand.grasp("slim", Transform((back, side, 0.0)))


def another(hand: Hand) -> None:
    hand.grasp(hand.random.choice(["other", "slim", "box", "box"]), Transform())


def card(hand: Hand) -> None:
    hand.grasp("card", Transform((0.01, 0.0, hand.random.uniform(-0.03, 0.03))))


def resting(hand: Hand) -> None:
    """Gripped, and a shelf below carries it."""
    hand.grasp("can", Transform((0.005, 0, 0.0)))
    at = hand.simulator.truth.pose("can").position
    low = float(PlacedBody(hand.things["can"], hand.simulator.truth.pose("can")).lowest)
    hand.shelf(at, low + 0.001)
    hand.ticks(10, hand.close())


def gripped_on_a_table(hand: Hand) -> None:
    """The fingers press on what stands there still: nothing of its weight shows."""
    hand.grasp("can", Transform((0.005, 0, 0.0)), on=True)


def weakly(hand: Hand) -> None:
    """Held with as little force as a slipping gripper has."""
    hand.grasp("can", Transform())
    hand.ticks(12, hand.close(0.0, hand.random.uniform(4.0, 9.0)))


def dropped(hand: Hand) -> None:
    hand.grasp("can", Transform())
    hand.away("can")
    hand.ticks(hand.random.integers(6, 25), hand.close())


def dropped_open(hand: Hand) -> None:
    """Lost while the fingers stay where they were."""
    hand.grasp("can", Transform())
    hand.away("can")
    width = hand.robot.state().gripper_width + hand.random.uniform(0.0, 0.01)
    hand.ticks(14, hand.close(min(width, hand.hand.max_width)))


def closed_on_nothing(hand: Hand) -> None:
    hand.ticks(35, hand.close())


def opened(hand: Hand) -> None:
    hand.ticks(5, hand.close(hand.hand.max_width))


def partly_open(hand: Hand) -> None:
    hand.ticks(35, hand.close(hand.random.uniform(0.02, 0.08)))


def jammed(hand: Hand) -> None:
    hand.blocked(hand.random.uniform(0.01, 0.09))
    hand.ticks(35, hand.close())


def jammed_before_the_can(hand: Hand) -> None:
    """Jammed, with the can behind the fingers or beside them, not between them."""
    hand.blocked(hand.random.uniform(0.03, 0.08))
    hand.ticks(35, hand.close())
    offset = hand.random.choice([0, 1])
    out = (0.14, 0.0, 0.0) if offset else (0.0, 0.0, -0.16)
    hand.simulator.put("can", hand.map_from_grasp() @ Transform(out))
    at = hand.simulator.truth.pose("can")
    hand.shelf(at.position, float(PlacedBody(hand.things["can"], at).lowest) - 0.001, 0.06)
    hand.ticks(5, hand.close())


def leaning_jammed(hand: Hand) -> None:
    """Jammed, and what is under the fingers carries a part of the hand."""
    hand.blocked(hand.random.uniform(0.02, 0.08))
    hand.ticks(35, hand.close())
    tips = (hand.map_from_grasp() @ Transform((hand.hand.pad_length / 2, 0.0, 0.0))).position
    hand.shelf(tips, float(tips[2]) - hand.hand.pad_height / 2 + 0.001, 0.06)
    hand.ticks(8, hand.close())


KINDS: tuple[Callable[[Hand], None], ...] = (
    held, tilted, leaning_across, by_its_edge, slipped_half_out, against_the_palm, another, card,
    resting, gripped_on_a_table, weakly, dropped, dropped_open, closed_on_nothing, opened,
    partly_open, jammed, jammed_before_the_can, leaning_jammed,
)  # fmt: skip
