"""A whole trip: localize, choose a goal pose, drive there, recover, or give up."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from momantu_bt.skill import Compute, compute
from momantu_skills.navigation.control.mppi import Mppi
from momantu_skills.navigation.drive.arrive import arrive, within
from momantu_skills.navigation.drive.cruise import cruise, leave
from momantu_skills.navigation.drive.manoeuvre import approach_is_sure, prepare, straight_behind
from momantu_skills.navigation.drive.moves import back_off, turn_to
from momantu_skills.navigation.drive.route import Route, choose, first_choice
from momantu_skills.navigation.drive.vehicle import Vehicle
from momantu_skills.navigation.localize.confidence import QUALITY, is_localized, sigmas
from momantu_skills.navigation.plan.goals import Stand

Trip = Generator[str | Compute, Any, None]

SURE_WITHIN = 2.5
"""Time for localization to become certain at rest, s: its scans at rest take 1.5 s."""
LOST = 1.0
"""Time for which a base that drives may be unsure where it is, s; then it stops."""
DOUBTS = 4
"""Stops to become sure where the base is, in one attempt."""
RECOVERABLE = ("PATH_BLOCKED", "NO_PROGRESS", "GOAL_BLOCKED", "NO_PATH")
LOCAL = 1.5
"""Distance from the goal below which the base uses manoeuvres instead of a planned path, m."""
PATIENCE = (1.0, 3.0, 6.0)
"""Waiting times of successive recoveries, s: an obstacle may be moving away."""
BACK = 0.3
"""How far the base backs up from what holds it, m."""
HELD = 1.0
"""Time for which the collision guard has held the base, s, that is more than a moment."""
WALK = 3.0
"""Goals that were measured from nearer than this, m, are kept in odom, which does not jump."""


class Destination:
    """Candidate stands (map), computed at each request, and the goal tolerance.

    in_odom: keep the chosen stand fixed in odom, for goals measured from the current place. thing:
    where what the stands belong to lies in the map now, which may move while the map is made.
    chosen: the stand of the newest attempt, map; None before the first.
    """

    def __init__(
        self,
        stands: Callable[[], list[Stand]],
        tolerance: tuple[float, float],
        *,
        side: int = 0,
        in_odom: bool = False,
        thing: Callable[[], Pose2D] | None = None,
    ) -> None:
        self.stands, self.tolerance = stands, tolerance
        self.side, self.in_odom, self.thing = side, in_odom, thing
        self.chosen: Pose2D | None = None


def travel(
    vehicle: Vehicle, mppi: Mppi, to: Destination, *, recovery: bool, quality: float = QUALITY
) -> Trip:
    """Drive to the destination; recover from failures where that is allowed.

    Where it is not, a base that the collision guard holds backs up before it gives up: the guard
    would hold it at the beginning of the next trip too. quality: least fit of the newest scan to
    the map at the start.

    Raises:
        Failure: NOT_LOCALIZED, START_KEPT_OUT, GOAL_KEPT_OUT, GOAL_BLOCKED, NO_PATH, PATH_BLOCKED,
            NO_PROGRESS.
    """
    yield from be_sure(vehicle, quality)
    _require_allowed(vehicle)
    attempts = vehicle.config.attempts if recovery else 1
    for attempt in range(attempts):
        try:
            yield from _surely(vehicle, lambda: _go(vehicle, mppi, to), quality)
            return
        except Failure as failure:
            recoverable = failure.code in RECOVERABLE
            if not recoverable or attempt == attempts - 1:
                held = recoverable and vehicle.blocked_for > HELD
                yield from vehicle.stop("give up")
                if held and not recovery:
                    yield from back_off(vehicle, BACK, "give up")
                raise
            yield from _recover(vehicle, attempt)
            yield from be_sure(vehicle, quality)  # what blocks a lost base may stand elsewhere


def be_sure(vehicle: Vehicle, quality: float = QUALITY) -> Trip:
    """Wait briefly until localization is certain; NOT_LOCALIZED if it is not."""
    end = vehicle.now() + SURE_WITHIN
    while not is_localized(vehicle.localization, quality):
        if vehicle.now() > end:
            position, yaw = sigmas(vehicle.localization.covariance)
            raise Failure(
                "NOT_LOCALIZED",
                f"the base may be anywhere within {position:.2f} m and {yaw:.2f} rad; the newest "
                f"scan fits the map by {vehicle.localization.quality:.2f}",
                sigma_position=position,
                sigma_yaw=yaw,
                quality=vehicle.localization.quality,
            )
        yield from vehicle.wait(vehicle.config.period, "localize")


def _surely(vehicle: Vehicle, go: Callable[[], Trip], quality: float) -> Trip:
    """Drive while localization is certain; else stop, look at rest, and begin to drive again."""
    for _ in range(DOUBTS):
        if (yield from _while_sure(vehicle, go(), quality)):
            return
        yield from vehicle.stop("localize")
        yield from be_sure(vehicle, quality)
    raise Failure(
        "NOT_LOCALIZED", f"the base stopped {DOUBTS} times because it was not sure where it was"
    )


def _while_sure(
    vehicle: Vehicle, drive: Trip, quality: float
) -> Generator[str | Compute, Any, bool]:
    """Drive to the end, True, or until localization has not been certain for `LOST` s, False."""
    answer, sure_at = None, vehicle.now()
    while True:
        try:
            step = drive.send(answer)
        except StopIteration:
            return True
        if is_localized(vehicle.localization, quality):
            sure_at = vehicle.now()
        if vehicle.now() - sure_at > LOST:
            drive.close()
            return False
        answer = yield step


def _require_allowed(vehicle: Vehicle) -> None:
    """Raise START_KEPT_OUT if the base stands in a zone to keep out of."""
    pose = vehicle.pose()
    zone = vehicle.costmap.zones.entered(pose, vehicle.base_discs)
    if zone is not None:
        raise Failure(
            "START_KEPT_OUT",
            f"the base stands at ({pose.x:.2f}, {pose.y:.2f}), in the keep-out zone {zone}; "
            "somebody must bring it out, or take the zone back",
            zone=zone,
            at=[pose.x, pose.y, pose.yaw],
        )


def _go(vehicle: Vehicle, mppi: Mppi, to: Destination) -> Trip:
    distance, angle = to.tolerance
    vehicle.sense()
    if (yield from _straight_back(vehicle, to)):
        return
    route: Route = yield from compute(
        lambda: choose(vehicle, to.stands(), to.side), vehicle.config.planning_time
    )
    to.chosen, goal = route.stand, _kept(vehicle, route.stand, to)
    if within(vehicle.pose(), goal(), distance, angle):
        return
    for _ in range(3):
        if not (yield from _near(vehicle, goal(), distance)):
            yield from leave(vehicle, route.heading(vehicle.pose()))
            yield from cruise(vehicle, mppi, route, distance)
            yield from _line_up(vehicle, goal(), distance)
        if (yield from arrive(vehicle, goal, distance, angle)):
            return
        route = yield from compute(
            lambda: choose(vehicle, to.stands(), to.side), vehicle.config.planning_time
        )
        to.chosen, goal = route.stand, _kept(vehicle, route.stand, to)
    raise Failure("NO_PROGRESS", "three approaches did not end at the goal")


def _straight_back(vehicle: Vehicle, to: Destination) -> Trip | Any:
    """Back up to the first choice if it lies straight behind; return whether it was reached.

    No path is planned: the arm may extend too far for any turn.
    """
    distance, angle = to.tolerance
    first = first_choice(vehicle, to.stands(), to.side)
    behind = None if first is None else straight_behind(vehicle, first.pose, distance)
    if first is None or behind is None or not (yield from back_off(vehicle, behind)):
        return False
    to.chosen, goal = first.pose, _kept(vehicle, first.pose, to)
    return (yield from arrive(vehicle, goal, distance, angle))


def _near(vehicle: Vehicle, goal: Pose2D, distance: float) -> Trip | Any:
    """Try a manoeuvre if the goal is near enough; return whether the approach is prepared."""
    if vehicle.pose().distance_to(goal) > LOCAL:
        return False
    return (yield from prepare(vehicle, goal, distance))


def _line_up(vehicle: Vehicle, goal: Pose2D, distance: float) -> Trip:
    """At the lead-in, turn or drive short straights until a simulated approach succeeds."""
    if approach_is_sure(vehicle, goal, distance):
        return
    yield from vehicle.stop("line up")
    yield from prepare(vehicle, goal, distance)


def _kept(vehicle: Vehicle, stand: Pose2D, to: Destination) -> Callable[[], Pose2D]:
    """Where a chosen stand is, asked again and again."""
    if to.thing is not None:
        return _beside(to.thing, stand)
    if not to.in_odom or vehicle.pose().distance_to(stand) > WALK:
        return lambda: stand
    odom_from_stand = vehicle.map_from_odom().inverse() @ stand
    return lambda: vehicle.map_from_odom() @ odom_from_stand


def _beside(thing: Callable[[], Pose2D], stand: Pose2D) -> Callable[[], Pose2D]:
    """A stand that moves with a thing of the map."""
    then = thing()
    thing_from_stand = then.inverse() @ stand
    return lambda: stand if thing() == then else thing() @ thing_from_stand


def _recover(vehicle: Vehicle, attempt: int) -> Trip:
    """Recover: clear the costmap and look again; then also back up; then also turn."""
    yield from vehicle.stop("recover")
    vehicle.costmap.clear_ahead(vehicle.pose(), vehicle.sight.blind)
    vehicle.sense()
    if attempt >= 1:
        yield from back_off(vehicle, BACK, "recover")
    if attempt >= 2:
        yield from turn_to(vehicle, vehicle.pose().yaw + 2.0, "recover")
    yield from vehicle.wait(PATIENCE[min(attempt, len(PATIENCE) - 1)], "recover")
