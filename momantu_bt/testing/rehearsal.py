"""Test runs of one skill: whole, halted, restarted and without sensors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.engine.encode import encode
from momantu_bt.engine.skills.services import ServiceCycleError, each_once, in_order
from momantu_bt.engine.skills.session import Session
from momantu_bt.engine.status import RUNNING
from momantu_bt.errors import PLUGIN_ERRORS, words_of
from momantu_bt.failure import SKILL_ERROR, WRONG_TYPE, FailureValue
from momantu_bt.formats.places import NOWHERE, Place
from momantu_bt.formats.problems import Problem
from momantu_bt.messages import plain
from momantu_bt.plugins import PluginError
from momantu_bt.robot import Robot
from momantu_bt.skill import Skill
from momantu_bt.testing.example_inputs import NoExample, example_inputs
from momantu_bt.testing.example_world import ExampleWorld
from momantu_bt.testing.robot import ScriptedRobot
from momantu_bt.testing.skill_run import SkillResult, run_skill
from momantu_bt.testing.world import ScriptedWorld
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.skill_calls import callees
from momantu_bt.world import TICK, World

STILL = 1.0
"""Simulated time after a halt, s, in which the skill must not command anything."""


class CannotRehearse(Exception):
    """The skill cannot be run here; the message says why and what to give."""


@dataclass(frozen=True, slots=True)
class Take:
    """One run. turns: ticks at which the phase changed."""

    skill: type[Skill]
    result: SkillResult | None
    commands: tuple[Any, ...] = ()
    turns: tuple[int, ...] = ()

    @property
    def status(self) -> str:
        """The status, as in `SkillResult`."""
        return "" if self.result is None else self.result.status

    @property
    def ticks(self) -> int:
        """The number of its steps."""
        return 0 if self.result is None else self.result.ticks

    @property
    def code(self) -> str | None:
        """The failure's code, if the skill failed by itself; None if it was halted."""
        return self.result.code if self.result is not None and self.status == "FAILURE" else None

    @property
    def broken(self) -> bool:
        """Whether it ended in a way that is not allowed for any skill."""
        return self.code in (SKILL_ERROR, WRONG_TYPE)

    def difference(self, other: Take) -> str:
        """The differences between two runs; empty if there are none."""
        mine, its = self.result, other.result
        if mine is None or its is None:
            return "" if mine is its else "how they end"
        if (self.status, self.code, mine.phases, mine.ticks) != (
            other.status,
            other.code,
            its.phases,
            its.ticks,
        ):
            return f"how they end: {mine.explain()} and {its.explain()}"
        if encode(self.commands) != encode(other.commands):
            return "what they command"
        if encode(plain(dict(mine.outputs))) != encode(plain(dict(its.outputs))):
            return "their outputs"
        return ""

    def findings(self, when: str = "") -> Iterator[Problem]:
        """The findings of this run."""
        said = f" {when}" if when else ""
        if self.broken and self.result is not None and self.result.failure is not None:
            yield _error(self.result.failure, said)


def _error(failure: FailureValue, said: str) -> Problem:
    """Which rule a SKILL_ERROR or WRONG_TYPE breaks."""
    message = f"{failure.message}{said}"
    if failure.code == WRONG_TYPE:
        return Problem("wrong-type", message)
    if "which it does not declare" in failure.message:
        return Problem("undeclared-code", message)
    if "ended without giving output" in failure.message:
        return Problem("output-never-given", message)
    if failure.data.get("exception") == "PermissionError":
        return Problem("undeclared-actuator", message)
    if failure.data.get("exception") in ("SystemExit", "GeneratorExit", "KeyboardInterrupt"):
        return Problem("escapes", f"{message}: nothing but Failure may leave")
    return Problem("exception", message, _last_line(str(failure.data.get("traceback", ""))))


def _last_line(traceback: str) -> Place:
    """The place where it was raised."""
    lines = [line.strip() for line in traceback.splitlines() if line.strip().startswith("File ")]
    if not lines:
        return NOWHERE
    file, line, *_ = lines[-1].removeprefix("File ").split(", ")
    return Place(file.strip(chr(34)), int(line.removeprefix("line ")))


@dataclass
class Rehearsals:
    """Runs a skill several times with equal arguments and worlds; `close` closes the worlds."""

    skill: type[Skill]
    example: Callable[[int], Mapping[str, Any]] | None
    seed: int
    max_time: float
    _registry: Registry = field(default_factory=Registry.installed)
    _worlds: list[World] = field(default_factory=list)

    def close(self) -> None:
        """Close every world that was made."""
        while self._worlds:
            self._worlds.pop().close()

    def whole(self) -> Take:
        """A run to its end, or to `max_time`."""
        return self._take(self._arguments())

    def blind(self) -> Take:
        """A run in which no sensor answers.

        A skill that needs services is not run, as the services would fail first.
        """
        if self._needs():
            return Take(self.skill, None)
        arguments = self._arguments()
        robot = _scripted(arguments["world"].robot)
        robot.dead = set(robot.description.sensors)
        return self._take(arguments)

    def halted(self, tick: int, *, restart: bool, whole: Take) -> Iterator[Problem]:
        """Halt the skill twice at a tick, then let time pass; with `restart` start it again."""
        arguments = self._arguments()
        robot = _scripted(arguments["world"].robot)
        found: list[Problem] = []
        began = len(robot.commands)

        def at_tick(count: int, session: Session) -> None:
            if count == tick and session.status is RUNNING:
                found.extend(_halt(session, robot, began, tick))

        take = self._take(arguments, at_tick)
        yield from take.findings(f"when it is halted at tick {tick}")
        yield from found
        yield from _stays_still(arguments["world"], robot, tick)
        if restart:
            again = self._take({**self._arguments(), "world": arguments["world"]})
            yield from again.findings(f"when it is started again after a halt at tick {tick}")
            if tick == 1 and (again.status, again.code) != (whole.status, whole.code):
                yield Problem(
                    "restart",
                    f"halted in its first tick and started again it ends with "
                    f"{again.code or again.status}, else with {whole.code or whole.status}",
                )

    def _take(
        self,
        arguments: Mapping[str, Any],
        on_tick: Callable[[int, Session], None] | None = None,
    ) -> Take:
        phases: list[str] = []

        def watch(session: Session, world: World) -> None:
            phases.append(session.phase)
            if on_tick is not None:
                on_tick(len(phases), session)

        robot = _scripted(arguments["world"].robot)
        before = len(robot.commands)
        result = run_skill(
            self.skill, seed=self.seed, max_time=self.max_time, on_tick=watch, **arguments
        )
        commands = tuple((time, name, goal) for time, name, goal in robot.commands[before:])
        turns = [i for i in range(1, len(phases) + 1) if phases[i - 2 : i - 1] != phases[i - 1 : i]]
        return Take(self.skill, result, commands, tuple(turns))

    def _arguments(self) -> dict[str, Any]:
        """Keyword arguments for `run_skill`: those of the example, and generated ones."""
        try:
            arguments = dict((self.example or self.skill.rehearsal)(self.seed))
        except PLUGIN_ERRORS as error:  # other people's code: it may raise anything
            raise CannotRehearse(f"its example raises {words_of(error)}") from error
        if "world" not in arguments:
            if "robot" in arguments or "site" in arguments:
                world = ScriptedWorld(arguments.pop("robot", None), arguments.pop("site", None))
            else:
                world = ExampleWorld(self.seed)
            arguments["world"] = world
        world = arguments["world"]
        self._worlds.append(world)
        if "services" not in arguments:
            arguments["services"] = self._services()
        given_inputs = arguments.get("inputs")
        try:
            arguments["inputs"] = example_inputs(
                self.skill, world.site, world.robot.description, given_inputs
            )
        except NoExample as error:
            raise CannotRehearse(f"{error}; {_GIVE}") from None
        return arguments

    def _needs(self) -> list[str]:
        """The services that the skill and those that it calls need."""
        try:
            called = callees([self.skill], self._registry.skills.__getitem__)
        except KeyError as error:
            raise CannotRehearse(f"it calls the skill {error}, which is not installed") from None
        except PluginError as error:
            raise CannotRehearse(str(error)) from None
        return [need for kind in (self.skill, *called.values()) for need in kind.needs]

    def _services(self) -> dict[str, Any]:
        try:
            ordered = in_order(self._needs(), self._registry.services.__getitem__)
            return dict(each_once(ordered, lambda _, kind: kind()))
        except KeyError as error:
            raise CannotRehearse(f"no service {error} is installed; {_GIVE}") from None
        except (PluginError, ServiceCycleError) as error:
            raise CannotRehearse(f"{error}; {_GIVE}") from None


_GIVE = "give it an example: the class method `rehearsal(seed)`, or `check_skill(…, example)`"


def _scripted(robot: Robot) -> ScriptedRobot:
    if not isinstance(robot, ScriptedRobot):
        raise CannotRehearse(f"it is rehearsed on a ScriptedRobot, not on {type(robot).__name__}")
    return robot


def _halt(session: Session, robot: ScriptedRobot, began: int, tick: int) -> Iterator[Problem]:
    """Halt twice; the second halt must not change anything."""
    session.halt()
    if session.failure is not None:
        yield Problem("halt", f"halting it at tick {tick}: {session.failure.message}")
    moving = _moving(robot, began)
    if moving:
        yield Problem("halt", f"halted at tick {tick} it leaves {moving} with a command")
    told = len(robot.commands)
    session.halt()
    if len(robot.commands) != told:
        yield Problem("halt", f"halting it a second time at tick {tick} commands something")


def _moving(robot: ScriptedRobot, began: int) -> str:
    """Actuators whose newest command is not a stop. began: ignore commands before this index."""
    newest = {actuator: goal for _, actuator, goal in robot.commands[began:]}
    return ", ".join(name for name, goal in newest.items() if goal is not None)


def _stays_still(world: ScriptedWorld, robot: ScriptedRobot, tick: int) -> Iterator[Problem]:
    told = len(robot.commands)
    for _ in range(round(STILL / TICK)):
        world.step()
    if len(robot.commands) != told:
        yield Problem("halt", f"it commands something after it was halted at tick {tick}")
