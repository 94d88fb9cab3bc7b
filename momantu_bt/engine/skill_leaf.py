"""The leaf that runs a skill, with a new instance for each start."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from momantu_bt.engine.label import ShowsValues
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.outside import SkillEnded, SkillSession, SkillStepped, Starter
from momantu_bt.engine.role import Role
from momantu_bt.engine.skills.session import SLOW_STEP
from momantu_bt.engine.status import RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED, FailureValue
from momantu_bt.skill import MISSING, Skill


class SkillLeaf(ShowsValues, TreeNode):
    """RUNNING at each `yield`, SUCCESS when `run` returns, FAILURE when it raises.

    Inputs are read at the start (live ones on each tick); outputs are written on SUCCESS (live ones
    when assigned, also before a FAILURE). A halt closes the generator and stops the actuators that
    the skill owns.
    slow_steps: ticks in which the skill took longer than SLOW_STEP of wall time outside `compute`.
    slowest: the longest of them, s.
    """

    def __init__(self, parts: Parts, *, kind: type[Skill], path: str) -> None:
        super().__init__(parts)
        self.kind = kind
        self.inputs = parts.inputs()
        self.outputs = parts.outputs()
        self.path = path
        self.session: SkillSession | None = None
        self.slow_steps = 0
        self.slowest = 0.0
        live = [port for port in kind.ports.values() if port.live]
        self._live_in = [p.name for p in live if p.direction == "in" and p.name in self.inputs]
        self._live_out = [p.name for p in live if p.direction == "out" and p.name in self.outputs]
        self._start: Starter | None = None
        self._written: dict[str, Any] = {}

    @property
    def role(self) -> Role:
        """Its role in displays: an action of the robot."""
        return Role.ACT

    @property
    def skill_name(self) -> str:
        """The skill's name in the tree file."""
        return self.model.type

    @property
    def note(self) -> str:
        """The running skill's latest phase."""
        return "" if self.session is None else self.session.phase

    def step(self) -> Status:
        """One step of the skill."""
        session, live = self.session, None
        if session is None:
            session = self.session = self._begin()
        elif self._live_in:
            live = {name: self.inputs[name] for name in self._live_in}
        watchdog, events = self.context.watchdog, self.context.events
        watchdog.begin_step()
        try:
            status = session.step(live)
        finally:
            watchdog.end_step()
        if events.has_subscribers(SkillStepped):
            events.publish(SkillStepped(self, session, status))
        if session.took > SLOW_STEP:
            self.slow_steps += 1
            self.slowest = max(self.slowest, session.took)
        if status is RUNNING:
            if self._live_out:
                self._write(session, self._live_out)
            return RUNNING
        self.session = None
        if events.has_subscribers(SkillEnded):
            events.publish(SkillEnded(self, session))
        if status is SUCCESS:
            if self.outputs:
                self._write(session, self.outputs)
            return SUCCESS
        if self._live_out:
            self._write(session, self._live_out)
        failure = session.failure or FailureValue(FAILED, "failed without a reason")
        return self.fail_with(self.own(failure))

    def clear(self) -> None:
        """Close the skill and stop the actuators that it owns."""
        session, self.session = self.session, None
        if session is not None:
            self.context.watchdog.begin_step()
            try:
                session.halt()
            finally:
                self.context.watchdog.end_step()
            if session.failure is not None:
                self.context.remark(f"{self.where}: while it was halted: {session.failure}")

    def _begin(self) -> SkillSession:
        self._written.clear()
        inputs = self.inputs.all()
        self.show_values(inputs)
        if self._start is None:
            self._start = self.context.outside.starter(self)
        return self._start(inputs)

    def _write(self, session: SkillSession, names: Collection[str]) -> None:
        values, written = session.outputs, self._written
        for name in names:
            value = values.get(name, MISSING)
            if value is not MISSING and value is not written.get(name, MISSING):
                written[name] = value
                self.outputs[name].cell.store(value)
