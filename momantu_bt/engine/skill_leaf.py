"""The leaf that runs a skill, with a new instance for each start."""

from __future__ import annotations

from typing import Any

from momantu_bt.engine.label import label
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.outside import SkillEnded, SkillSession, SkillStepped
from momantu_bt.engine.role import Role
from momantu_bt.engine.skills.session import SLOW_STEP
from momantu_bt.engine.status import FAILURE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED, FailureValue
from momantu_bt.skill import Skill


class SkillLeaf(TreeNode):
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
        self._live_in = [p.name for p in kind.ports.values() if p.direction == "in" and p.live]
        self._live_out = [p.name for p in kind.ports.values() if p.direction == "out" and p.live]
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
        if self.session is None:
            self.session = self._begin()
            live = None
        else:
            live = {name: self.inputs[name] for name in self._live_in if name in self.inputs}
        session, watchdog = self.session, self.context.watchdog
        watchdog.begin_step()
        try:
            status = session.step(live)
        finally:
            watchdog.end_step()
        events = self.context.events
        events.publish(SkillStepped(self, session, status))
        self._note_time(session)
        if status is RUNNING:
            self._write(session, self._live_out)
            return RUNNING
        self.session = None
        events.publish(SkillEnded(self, session))
        if status is SUCCESS:
            self._write(session, list(self.outputs))
            return SUCCESS
        self._write(session, self._live_out)
        failure = session.failure or FailureValue(FAILED, "failed without a reason")
        self.fail_with(self.own(failure))
        return FAILURE

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
        self._written = {}
        inputs = self.inputs.all()
        self.label = label(self.model, inputs)
        return self.context.outside.begin(self, inputs)

    def _write(self, session: SkillSession, names: list[str]) -> None:
        if not names:
            return
        values = session.outputs
        for name in names:
            output = self.outputs.get(name)
            if output is None or name not in values:
                continue
            if self._written.get(name) is not values[name]:
                self._written[name] = values[name]
                output.cell.store(values[name])

    def _note_time(self, session: SkillSession) -> None:
        if session.took > SLOW_STEP:
            self.slow_steps += 1
            self.slowest = max(self.slowest, session.took)
