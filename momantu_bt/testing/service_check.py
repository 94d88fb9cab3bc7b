"""Check a service against the rules for all services, without a simulator."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from momantu_bt.engine.encode import encode
from momantu_bt.engine.skills.actuators import Actuators
from momantu_bt.engine.skills.services import (
    ServiceCycleError,
    ServiceError,
    Services,
    in_order,
)
from momantu_bt.failure import Failure
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.frames import FrameBuffer
from momantu_bt.messages import BaseVelocity, plain
from momantu_bt.plugins import PluginError
from momantu_bt.robot import Robot
from momantu_bt.service import Service
from momantu_bt.skill import Port
from momantu_bt.testing.clock_rules import ClockWatch, clocks_in_source
from momantu_bt.testing.example_world import ExampleWorld
from momantu_bt.testing.world import ScriptedWorld
from momantu_bt.tree.plugins import service_objection
from momantu_bt.tree.registry import Registry
from momantu_bt.values.admit import admit_output
from momantu_bt.world import TICK

SECONDS = 5.0
"""Simulated time of a run, s."""


def check_service(
    service: type[Service],
    *,
    name: str = "",
    parameters: Mapping[str, Any] | None = None,
    seed: int = 0,
) -> list[Problem]:
    """Find everything that is wrong with a service, from its source and by running it.

    It runs in `ExampleWorld` on a robot that drives and turns, with the installed services that it
    needs. name: as trees read it; by default the class's name. parameters: what a site sets of it.

    Returns: the problems; for a correct service the list is empty or has only notes.
    """
    wrong = service_objection(name or "a_service", service)
    if wrong is not None:
        return [Problem("docs", wrong)]
    found = [_worded(each) for each in clocks_in_source(service)]
    runs = _Runs(service, name or service.__name__, dict(parameters or {}), seed)
    try:
        with ClockWatch(service) as watch:
            whole = runs.take()
        found += map(_worded, watch.findings())
        found += whole.problems
        if not whole.problems:
            if encode(whole.published) != encode(runs.take().published):
                found.append(Problem("not-deterministic", "two runs with one seed differ"))
            found += runs.take(blind=True).problems
    except (KeyError, PluginError, ServiceCycleError) as error:
        found.append(Problem("not-rehearsed", f"the services that it needs cannot run: {error}"))
    return list({(each.code, each.message, each.place): each for each in found}.values())


def assert_service(service: type[Service], **options: Any) -> None:
    """As `check_service`, but raise an AssertionError that lists the problems, if there are any."""
    found = check_service(service, **options)
    wrong = [each for each in found if each.severity is not Severity.HINT]
    if wrong:
        lines = "\n".join(f"  {finding}" for finding in wrong)
        raise AssertionError(f"{service.__name__}:\n{lines}")


def _worded(problem: Problem) -> Problem:
    """A finding about clocks in the words of services."""
    message = problem.message.replace("ask self.clock", "use the `now` of update")
    return replace(problem, message=message.replace("self.random", "context.random"))


@dataclass
class _Take:
    """One run. published: after each tick, as plain values."""

    published: list[Any] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)


@dataclass
class _Runs:
    service: type[Service]
    name: str
    parameters: dict[str, Any]
    seed: int

    def take(self, *, blind: bool = False) -> _Take:
        """A new instance for SECONDS. blind: no sensor answers."""
        world, take = ExampleWorld(self.seed), _Take()
        try:
            self._run(world, take, blind)
        except ServiceError as error:
            said = " when no sensor answers" if blind else ""
            take.problems.append(_raised(error, said))
        finally:
            world.close()
        return take

    def _run(self, world: ScriptedWorld, take: _Take, blind: bool) -> None:
        robot = world.robot
        installed = Registry.installed().services
        needed = in_order(self.service.needs, installed.__getitem__)
        instances = {name: kind() for name, kind in needed.items()} | {self.name: self.service()}
        services = Services(instances, Actuators(robot))
        frames = FrameBuffer(robot.description.kinematics())
        frames.add_state(robot.state())
        site = replace(world.site.of_a_run(), services={self.name: self.parameters})
        services.start(site, frames, world, self.seed)
        if blind:
            robot.dead = set(robot.description.sensors)
        updates = _counted(instances[self.name])
        for tick in range(round(SECONDS / TICK)):
            turning = 0.4 if tick % 40 > 20 else 0.0
            robot.command("base", BaseVelocity(0.2, turning))
            world.step()
            frames.add_state(robot.state())
            services.update(world.now())
            self._look(services, take)
            if take.problems:
                return
        take.problems += _rate(self.service.rate, len(updates))

    def _look(self, services: Services, take: _Take) -> None:
        """Compare what is published with what is declared."""
        declared = self.service.publishes
        try:
            values = dict(services.published(self.name))
            again = dict(services.published(self.name))
        except Failure as failure:
            take.published.append(str(failure))
            return
        take.problems += _names(declared, values)
        for key in declared.keys() & values.keys():
            try:
                admit_output(values[key], Port(key, "out", declared[key], ""))
            except Failure as failure:
                take.problems.append(Problem("wrong-type", failure.value.message))
        shown = plain(values)
        if encode(shown) != encode(plain(again)):
            message = "asking twice for what it publishes gives two answers"
            take.problems.append(Problem("published-changes", message))
        take.published.append(shown)


def _counted(service: Service) -> list[float]:
    """The times of a service's updates, which fill from now on."""
    times: list[float] = []
    update = service.update

    def noting(robot: Robot, now: float) -> None:
        times.append(now)
        update(robot, now)

    service.update = noting  # type: ignore[method-assign]
    return times


def _rate(declared: float, updates: int) -> Iterator[Problem]:
    """Compare the rate that a service declares with the one that it gets in a run."""
    if abs(updates - SECONDS * declared) <= 1.0 + 0.02 * SECONDS * declared:
        return
    got = updates / SECONDS
    message = f"declares a rate of {declared:g} Hz and is updated at {got:g} Hz"
    yield Problem("rate", f"{message}: the clock ticks at {1 / TICK:g} Hz")


def _names(declared: Mapping[str, type], values: Mapping[str, Any]) -> Iterator[Problem]:
    for key in sorted(values.keys() - declared.keys()):
        message = f"publishes {key!r}, which `publishes` does not declare"
        yield Problem("undeclared-key", message)
    for key in sorted(declared.keys() - values.keys()):
        yield Problem("key-never-given", f"declares {key!r} and does not publish it")


def _raised(error: ServiceError, said: str) -> Problem:
    message = f"{error}{said}".replace(" ended the run", "")
    if isinstance(error.__cause__, PermissionError):
        return Problem("commands", message)
    return Problem("exception", message)
