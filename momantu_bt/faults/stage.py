"""Prepare a run for the requested faults."""

from __future__ import annotations

import os
import signal
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from momantu_bt.engine.build import Built
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.executor import Stepping
from momantu_bt.fault import Effect, Fault, FaultError, FaultyWorld
from momantu_bt.fault_kind import FaultKind, Where
from momantu_bt.faults.director import Director, Staged
from momantu_bt.faults.effects import robot as at_robot
from momantu_bt.faults.effects import site as at_site
from momantu_bt.faults.effects.skills import skill_fault
from momantu_bt.faults.effects.skills.victim import SkillFault
from momantu_bt.faults.kinds.catalogue import kinds
from momantu_bt.faults.phase import START, Phase, parse_phase
from momantu_bt.faults.phases import check_phase, usual_phase
from momantu_bt.faults.tree_file import TreeFaults, tree_faults
from momantu_bt.faults.watch import PhaseWatch
from momantu_bt.formats.names import valid_names
from momantu_bt.record.report import FaultReport
from momantu_bt.robot import Robot
from momantu_bt.skill import Skill
from momantu_bt.tree.model import Document
from momantu_bt.tree.substitute.substitution import Substitution
from momantu_bt.wheels import corrected_base
from momantu_bt.world import Site, World


@dataclass(frozen=True, slots=True)
class Planned:
    """A fault that this tree can have, with its phase settled."""

    fault: Fault
    kind: FaultKind
    phase: Phase


def plan(
    faults: Sequence[Fault],
    document: Document,
    skills: Mapping[str, type[Skill]],
    substitution: Substitution,
    *,
    with_world: bool,
) -> tuple[Planned, ...]:
    """Settle when each fault begins, before anything is started.

    skills: those that the run can reach.

    Raises:
        FaultError: the tree or the run lacks what a fault needs; the message says what it has.
        TreeError, TreeNotFound: the file of faults beside the tree is wrong.
    """
    planned = []
    told = tree_faults(document) if faults else TreeFaults()
    for fault in faults:
        kind = kinds()[fault.name]
        if kind.place is not Where.PROCESS and not with_world:
            raise FaultError(f"{fault.name}: this run has no world, and so no robot and no skills")
        if kind.place is Where.SKILL and not skills:
            raise FaultError(f"{fault.name}: the tree runs no skill")
        own = told.begins.get(fault.name)
        text = fault.phase or usual_phase(kind, document, skills, substitution, own)
        if kind.place is Where.SITE and parse_phase(text) != parse_phase(START):
            raise FaultError(f"{fault.name} is so from the start on; it takes no phase {text!r}")
        phase = check_phase(text, document, substitution)
        planned.append(Planned(replace(fault, phase=text), kind, phase))
    return tuple(planned)


class Stage:
    """The robot, the site and the skills of one run, ready for its faults.

    world: None in a run without a world, which has neither robot nor site. site: what the robot is
    told before any fault. `stack` frees whatever
    the faults needed.

    Raises:
        FaultError: the world or the robot cannot have a fault.
    """

    def __init__(
        self,
        planned: Sequence[Planned],
        world: World | None,
        seed: int,
        stack: ExitStack,
        site: Site | None,
    ) -> None:
        self.world = world
        self._planned = planned
        self._effects: list[Effect | None] = []
        self._director: Director | None = None
        self.robot: Robot | None = None if world is None else world.robot
        self.site = site
        for one in planned:
            self._effects.append(self._effect(one, world, seed, stack))
        if self.robot is not None:
            self.robot = corrected_base(self.robot)

    def skill(self, kind: type[Skill]) -> type[Skill]:
        """A skill's class as the run uses it."""
        for effect in self._effects:
            if isinstance(effect, SkillFault):
                kind = effect.wrapped(kind)
        return kind

    def direct(self, built: Built, context: RunContext, document: Document) -> None:
        """Let the faults happen between the ticks of the run."""
        if not self._planned:
            return
        staged = [
            Staged(one.fault, PhaseWatch(one.phase, built.nodes, document), effect)
            for one, effect in zip(self._planned, self._effects, strict=True)
        ]
        director = self._director = Director(staged, built.nodes, context.remark)
        context.events.subscribe(Stepping, lambda event: director.act(context, event.settling))

    def reports(self) -> tuple[FaultReport, ...]:
        """The outcome of each fault, in their given order."""
        return () if self._director is None else self._director.reports()

    def _effect(
        self, one: Planned, world: World | None, seed: int, stack: ExitStack
    ) -> Effect | None:
        fault, place = one.fault, one.kind.place
        if place is Where.PROCESS:
            return Killed()
        if place is Where.SKILL:
            return skill_fault(fault)
        assert world is not None
        assert self.robot is not None
        assert self.site is not None
        if place is Where.WORLD:
            return _of_world(fault, world)
        if place is Where.ROBOT:
            layer = at_robot.layer(self.robot, fault, seed)
            self.robot = layer
            return layer
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="momantu_bt_site_"))
        self.site = at_site.wrong_site(self.site, fault, seed, Path(folder))
        return None


def _of_world(fault: Fault, world: World) -> Effect:
    having = world.faults() if isinstance(world, FaultyWorld) else ()
    if fault.name not in having or not isinstance(world, FaultyWorld):
        hint = valid_names(fault.name, having, "faults of the world's own")
        raise FaultError(f"the world {world.name} cannot make {fault.name}; {hint}")
    return world.effect(fault)


class Killed:
    """`process.killed`. Implements `Effect`."""

    def begin(self) -> None:
        """End the process at once, without any notice."""
        os.kill(os.getpid(), signal.SIGKILL)

    def end(self) -> None:
        """Do nothing: the process is gone."""
