"""Runs a tree: steps the world, services, tree and observers, until the robot stands still."""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, Protocol

from momantu_bt import collector
from momantu_bt.engine import ending
from momantu_bt.engine.build import Built
from momantu_bt.engine.causes import running_as_cause
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.ending import Ending
from momantu_bt.engine.fingerprint import Fingerprint
from momantu_bt.engine.interrupts import Interrupts
from momantu_bt.engine.node import TreeNode, ticked_in
from momantu_bt.engine.pace import Pace
from momantu_bt.engine.raised import raised_at
from momantu_bt.engine.skills.body import Body
from momantu_bt.engine.skills.services import ServiceError, Services
from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.engine.standstill import Standstill
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, Status
from momantu_bt.errors import StopRequested, words_of
from momantu_bt.failure import TIMEOUT, FailureValue
from momantu_bt.messages import RobotState
from momantu_bt.world import Verdict, World

SETTLE = 1.5
"""Least simulated time after the end, s, for everything to stop; the referee needs 1 s of
stillness."""
LONGEST_SETTLE = 12.0
"""Most simulated time after the end for a robot that still moves, s: a heavy base that brakes from
2 m/s at 0.25 m/s2 needs 8 s."""


class Stepper(Protocol):
    """A world, or only a clock for a tree without a world."""

    def now(self) -> float:
        """Seconds since the run began."""
        ...

    def step(self) -> None:
        """Advance by one tick."""
        ...


class Observer(Protocol):
    """Observes each tick without changing the run."""

    def ticked(self, run: Executor) -> None:
        """Called after each tick, and after each step while the robot comes to rest."""
        ...

    def close(self) -> None:
        """Called when the run is over."""
        ...


class Stepping(NamedTuple):
    """The world will step now. settling: the tree has ended and the robot is coming to rest."""

    settling: bool


class Ticked(NamedTuple):
    """A tick is over, or a step while the robot comes to rest. The journals still describe it."""

    run: Executor


class NodeStarting(NamedTuple):
    """A node that is not running will be ticked now."""

    node: TreeNode


class Executor:
    """Runs one tree once.

    settling: the tree has ended and the robot is coming to rest. state: the robot's last state.
    """

    def __init__(
        self,
        built: Built,
        context: RunContext,
        stepper: Stepper,
        *,
        world: World | None = None,
        services: Services | None = None,
        max_time: float = 600.0,
        realtime: bool = False,
    ) -> None:
        self.built = built
        self.context = context
        self.world = world
        self.services = services or Services({}, None)
        self.fingerprint = Fingerprint()
        self.settling = False
        self._stepper = stepper
        self._max_time = max_time
        self._realtime = realtime
        self.state: RobotState | None = None
        self._error: str | None = None
        self._world_is_sound = True
        self._failure: FailureValue | None = None
        self._depth = sys.getrecursionlimit()

    def show_to(self, observer: Observer) -> None:
        """Show each tick to an observer."""
        self.context.events.subscribe(Ticked, lambda event: observer.ticked(event.run))

    def run(self, interrupts: Interrupts) -> Ending:
        """Run from the first tick to the last. Nothing is raised, whatever plug-ins raise."""
        started = time.perf_counter()
        interrupts.patient = True
        self._publish_starts(interrupts)
        try:
            status = self._until_end(interrupts)
        except BaseException as error:  # services, worlds and nodes: they may raise anything
            status = self._broken_by(error, interrupts)
        sim_time, ticks = self.context.now, self.context.tick
        verdict = self._come_to_rest(status)
        wall_time = time.perf_counter() - started
        if self._error is not None:
            status = ending.ERROR
        by = interrupts.by if status == ending.INTERRUPTED else None
        return Ending(status, self._failure, verdict, sim_time, wall_time, ticks, self._error, by)

    def _broken_by(self, error: BaseException, interrupts: Interrupts) -> str:
        """The status of a run that an exception ended: INTERRUPTED after a signal, else ERROR."""
        ours = isinstance(error, StopRequested) or not interrupts.caught
        if ours and isinstance(error, KeyboardInterrupt):
            return ending.INTERRUPTED
        self._error = _told(error)
        return ending.ERROR

    def _publish_starts(self, interrupts: Interrupts) -> None:
        """Make nodes publish their starts, if anyone subscribes; an interrupt suspends the tree."""
        if not self.context.events.has_subscribers(NodeStarting):
            return
        for node in self.built.nodes:
            setattr(node, "execute", self._publishing(node, node.execute, interrupts))  # noqa: B010

    def _publishing(
        self, node: TreeNode, execute: Callable[[], Status], interrupts: Interrupts
    ) -> Callable[[], Status]:
        def publish_and_execute() -> Status:
            if node.state is not RUNNING and not interrupts.requested:
                self.context.events.publish(NodeStarting(node))
            return RUNNING if interrupts.requested else execute()

        return publish_and_execute

    def _until_end(self, interrupts: Interrupts) -> str:
        self.begin()
        pace = Pace() if self._realtime else None
        with collector.frozen():
            while not interrupts.requested:
                status = self.tick()
                self._hold(interrupts)
                if status is not RUNNING:
                    self._failure = self.built.root.failure if status is FAILURE else None
                    return ending.FAILURE if status is FAILURE else ending.SUCCESS
                if self.context.now >= self._max_time - CLOCK_SLACK:
                    self._failure = self._timed_out()
                    return ending.FAILURE
                if pace is not None:
                    pace.hold(self.context.now)
        return ending.INTERRUPTED

    def _hold(self, interrupts: Interrupts) -> None:
        """Undo what would keep Ctrl-C or the engine from working: signals, the recursion limit."""
        changed = list(interrupts.hold())
        if sys.getrecursionlimit() < self._depth:
            changed.append(f"the recursion limit ({sys.getrecursionlimit()})")
            sys.setrecursionlimit(self._depth)
        if changed:
            running = [n.where for n in self.built.nodes if n.ticked_at == self.context.tick]
            where = running[-1] if running else "a service"
            self.context.remark(f"{where}: changed {', '.join(changed)}; it is as before again")

    def _step(self) -> None:
        """Step the world; mark it as broken while the step lasts, in case it raises."""
        if self._error is None:
            self.context.events.publish(Stepping(self.settling))
        self.context.watchdog.beat()
        self._world_is_sound = False
        self._stepper.step()
        self._world_is_sound = True

    def begin(self) -> None:
        """Start the services; call it before the first tick."""
        body = self.context.body
        self.fingerprint.add(None, (), (), self._written())
        if body is not None:
            body.frames.add_state(body.actuators.robot.state())
            self.services.start(body.site, body.frames, self._stepper, self.context.seed)

    def tick(self) -> Status:
        """Run one tick: step the world, then the services, the tree and the observers."""
        self._pass_time()
        status = self.built.root.execute()
        self._note()
        return status

    def idle(self) -> None:
        """Run one tick without the tree: step the world, then the services and the observers."""
        self._pass_time()
        self._note()

    def _pass_time(self) -> None:
        self._step()
        self.context.begin_tick()
        body = self.context.body
        if body is not None:
            self.state = body.actuators.robot.state()
            body.frames.add_state(self.state)
        self.services.update(self.context.now)

    def _note(self) -> None:
        """Add the tick to the fingerprint, then call the observers."""
        context, body = self.context, self.context.body
        issued = [] if body is None else body.actuators.issued
        self.fingerprint.add(
            self.state,
            issued,
            [(change.node.index, change.status.value) for change in context.changes],
            self._written(),
        )
        context.events.publish(Ticked(self))
        issued.clear()

    def _written(self) -> list[tuple[str, Any]]:
        return [(cell.name, cell.value) for cell, _ in self.context.writes]

    def _timed_out(self) -> FailureValue:
        root = self.built.root
        cause = running_as_cause(root, self.context.now)
        return root.own(
            FailureValue(TIMEOUT, f"the run took longer than {self._max_time:g} s", cause=cause)
        )

    def _come_to_rest(self, status: str) -> Verdict | None:
        """Halt the tree, stop the actuators, let the world come to rest; then ask the referee."""
        self.context.changes.clear()
        self.context.writes.clear()
        self.context.logs.clear()
        try:
            self.stop()
            if status == ending.ERROR:
                self._settle_unseen()
                return None
            self.settling = True
            self._settle()
            return None if self.world is None else self.world.verdict()
        except StopRequested:
            return None
        except BaseException as error:
            self._error = self._error or _told(error)
            return None

    def stop(self) -> None:
        """Halt the tree and stop every actuator, even if halting the tree raises."""
        try:
            halt_tree(self.built, broken=self._error is not None)
        finally:
            if self.context.body is not None:
                self.context.body.actuators.stop_all()

    def _settle(self) -> None:
        body = self.context.body
        if body is None:
            return
        for _ in self._coming_to_rest(body):
            self._note()
            self._step()
            self.context.begin_tick()
            self.state = body.actuators.robot.state()
        self._note()

    def _settle_unseen(self) -> None:
        """Let the world come to rest after an error, without observers, as one may be the cause."""
        body = self.context.body
        if self.world is None or body is None or not self._world_is_sound:
            return
        for _ in self._coming_to_rest(body):
            self._step()

    def _coming_to_rest(self, body: Body) -> Iterator[None]:
        """One item for each step until the robot is measured to stand still.

        A robot that moves longer than usual is told to stop again at each step.
        """
        robot, standstill = body.actuators.robot, Standstill()
        began = self._stepper.now()
        standstill.add(robot.state())
        while True:
            after = self._stepper.now() - began + CLOCK_SLACK
            if after >= SETTLE and standstill.still:
                return
            if after >= LONGEST_SETTLE:
                what = standstill.moving or "the robot"
                self.context.remark(f"{what} still moves {after:.0f} s after the end of the run")
                return
            if after >= SETTLE:
                body.actuators.stop_all()
            yield
            standstill.add(robot.state())


def _told(error: BaseException) -> str:
    """The traceback of an error; the last line is a sentence with its plug-in's node and line."""
    *trace, last = "".join(traceback.format_exception(error)).rstrip().splitlines()
    node = ticked_in(error)
    if isinstance(error, ServiceError):
        last = str(error)
    elif node is not None:
        last = f"{words_of(error)}, in the node {node.where}"
        place = raised_at(error, type(node).__module__)
        last += f", at {place}" if place else ""
    return "\n".join([*trace, " ".join(last.splitlines()), ""])


def halt_tree(built: Built, *, broken: bool = False) -> None:
    """Halt a tree; all its nodes are halted even if one raises, and the first exception is raised.

    broken: an exception may have left nodes running; they are halted each by itself. Otherwise a
    node that is still marked as running was skipped since, and has nothing left to do.
    """
    troubles: list[BaseException] = []
    try:
        built.root.reset()
    except BaseException as trouble:  # a plug-in's code; a signal waits until all are halted
        troubles.append(trouble)
    for node in reversed(built.nodes):
        try:
            if node.state is RUNNING and (broken or troubles):
                node.halt()
            node.clear()
            node.state = IDLE
        except BaseException as trouble:
            troubles.append(trouble)
    if troubles:
        raise troubles[0]
