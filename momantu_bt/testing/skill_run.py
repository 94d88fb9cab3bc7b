"""Run one skill without a tree, in a scripted or a real world."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.claim import Claim
from momantu_bt.engine.skills.actuators import Actuators
from momantu_bt.engine.skills.services import Services
from momantu_bt.engine.skills.session import Session
from momantu_bt.engine.skills.start import Setup, SkillContext
from momantu_bt.engine.status import FAILURE, RUNNING
from momantu_bt.failure import Failure, FailureValue
from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Transform
from momantu_bt.marker import Marker
from momantu_bt.robot import Robot
from momantu_bt.service import Localization, Service, offers
from momantu_bt.skill import Host, Skill
from momantu_bt.testing.robot import ScriptedRobot
from momantu_bt.testing.world import ScriptedWorld
from momantu_bt.tree.plugins import SKILLS
from momantu_bt.values.admit import admit
from momantu_bt.world import TICK, Site, World


@dataclass(frozen=True, slots=True)
class SkillResult:
    """How a run ended.

    status: SUCCESS, FAILURE, or HALTED if `max_time` was over first. phases: the phases in order,
    without repetitions. duration: time of the world's clock, s. ticks: number of steps.
    skill: the instance; None if it could not be created. logs, markers: what it logged and drew.
    """

    status: str
    outputs: Mapping[str, Any]
    failure: FailureValue | None
    phases: tuple[str, ...]
    duration: float
    ticks: int
    skill: Skill | None
    robot: Robot
    logs: tuple[str, ...] = ()
    markers: tuple[Marker, ...] = ()

    @property
    def code(self) -> str | None:
        """The failure's code, if it failed."""
        return None if self.failure is None else self.failure.code

    def claim(self) -> Claim | None:
        """What the result claims about the world; None without a claim or after a halt."""
        if self.skill is None or self.status == "HALTED":
            return None
        return self.skill.claim(self.robot, self.failure)

    def explain(self) -> str:
        """All details of the result, with the traceback of a failure, for assertion messages."""
        if self.failure is None:
            return f"{self.status} after {self.duration:.2f} s in {' > '.join(self.phases)}"
        trace = self.failure.data.get("traceback", "")
        chain = " <- ".join(str(link) for link in self.failure.chain())
        return f"{chain} {dict(self.failure.data) if not trace else ''}\n{trace}"


def run_skill(
    skill: type[Skill],
    *,
    robot: ScriptedRobot | None = None,
    inputs: Mapping[str, Any] | None = None,
    services: Mapping[str, Any] | None = None,
    site: Site | None = None,
    world: World | None = None,
    frames: FrameBuffer | None = None,
    map_from_odom: Transform | None = None,
    skills: Mapping[str, type[Skill]] | None = None,
    seed: int = 0,
    max_time: float = 60.0,
    on_tick: Callable[[Session, World], None] | None = None,
) -> SkillResult:
    """Start a skill and tick it to its end, as the engine does.

    robot, site: by default a ScriptedRobot at the origin and a scripted site. Or give `world`,
    which has both. services: by name. Instances of `Service` are started, and updated at their
    rate; if `frames` is given, they count as already started. Other objects are used unchanged.
    map_from_odom: set in the frame buffer at the start; by default the identity if no service is
    a Localization.
    skills: those that it may call by name, such as stand-ins; by default the installed ones.
    frames: the buffer of an earlier run in the same world, to run skills one after the other.
    on_tick: called after each step of the skill, to script events. The skill is halted after
    `max_time` simulated seconds.
    """
    place = world if world is not None else ScriptedWorld(robot, site)
    try:
        admitted = _admitted(skill, inputs or {})
    except Failure as failure:
        return SkillResult("FAILURE", {}, failure.value, (), 0.0, 0, None, place.robot)
    running = _Services(place, dict(services or {}), frames, seed)
    localized = any(offers(each, Localization) for each in running.services.values())
    if map_from_odom is not None or (frames is None and not localized):
        running.frames.set_map_from_odom(map_from_odom or Transform(), place.now())
    reporter = _Listening()
    context = SkillContext(
        clock=place,
        frames=running.frames,
        site=running.site,
        services=running.services,
        skills=SKILLS if skills is None else skills,
        reporter=reporter,
    )
    lease = Actuators(place.robot).lease(skill.__name__, skill.uses)
    session = Session(Setup(skill, lease, context), admitted, (seed, skill.__name__, 1))
    began = place.now()
    course = _tick_to_end(session, place, running, max_time, on_tick)
    return SkillResult(
        status="HALTED" if course.halted else session.status.value,
        outputs={} if session.status is FAILURE else session.outputs,
        failure=session.failure,
        phases=tuple(course.phases),
        duration=place.now() - began,
        ticks=course.ticks,
        skill=session.skill,
        robot=place.robot,
        logs=tuple(reporter.logs),
        markers=tuple(reporter.markers),
    )


@dataclass(slots=True)
class _Course:
    """How a run went. halted: it took too long."""

    phases: list[str] = field(default_factory=list)
    ticks: int = 0
    halted: bool = False


def _tick_to_end(
    session: Session,
    place: World,
    running: _Services,
    max_time: float,
    on_tick: Callable[[Session, World], None] | None,
) -> _Course:
    """Tick the skill until it ends, or halt it after `max_time` simulated seconds."""
    course, began, phase = _Course(), place.now(), ""
    try:
        while place.now() - began < max_time - TICK / 2:
            running.update()
            session.step()
            course.ticks += 1
            if session.phase != phase:
                phase = session.phase
                course.phases.append(phase)
            if on_tick is not None:
                on_tick(session, place)
            if session.status is not RUNNING:
                break
            place.step()
    finally:
        course.halted = session.status is RUNNING
        session.halt()
    return course


class _Listening(Host):
    """Keeps what the skill logs and draws."""

    @property
    def watched(self) -> bool:
        return True

    def __init__(self) -> None:
        self.logs: list[str] = []
        self.markers: list[Marker] = []

    def log(self, text: str) -> None:
        self.logs.append(text)

    def draw(self, markers: Sequence[Marker]) -> None:
        self.markers += markers


def _admitted(skill: type[Skill], inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Convert inputs as a tree would; unknown ones stay as they are.

    Raises:
        Failure: WRONG_TYPE, a value does not fit its input.
    """
    ports = skill.ports
    return {n: admit(v, ports[n]) if n in ports else v for n, v in inputs.items()}


class _Services:
    """The services of a run without a tree, and the frame buffer they share."""

    def __init__(
        self, world: World, services: dict[str, Any], frames: FrameBuffer | None, seed: int
    ) -> None:
        self.services = services
        self.site = world.site if frames is not None else world.site.of_a_run()
        self._world = world
        self.frames = frames or FrameBuffer(world.robot.description.kinematics())
        ticking = {n: s for n, s in services.items() if isinstance(s, Service)}
        self._ticking = Services(ticking, Actuators(world.robot))
        if frames is None:
            self.frames.add_state(world.robot.state())
            self._ticking.start(
                self.site, self.frames, world, seed, other=self.services.__getitem__
            )

    def update(self) -> None:
        """Remember the robot's state and update the services that are due."""
        self.frames.add_state(self._world.robot.state())
        self._ticking.update(self._world.now())
