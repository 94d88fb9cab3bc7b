"""One start of one skill: from its inputs to its outputs or its failure, a step a tick."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from momantu_bt.engine.skills.actuators import Lease
from momantu_bt.engine.skills.calls import SkillHost
from momantu_bt.engine.skills.errors import declared, hung_failure, skill_error
from momantu_bt.engine.skills.start import (
    SkillContext,
    admitted,
    begun,
    instance,
    outputs_at_end,
)
from momantu_bt.engine.status import FAILURE, RUNNING, SUCCESS, Status
from momantu_bt.engine.watchdog import Hung
from momantu_bt.errors import StopRequested
from momantu_bt.failure import Failure, FailureValue
from momantu_bt.skill import MISSING, Compute, Port, Run, Skill

SLOW_STEP = 0.020
"""Seconds of wall time that a skill may use in one tick without declaring them as `compute`."""
CLOCK_SLACK = 1e-9
"""Tolerance for rounding when the clock is compared with a deadline, s."""


class Session:
    """Runs one skill instance. Call `step` once a tick until it no longer returns RUNNING.

    status: of the newest step. phase: what the skill last yielded. failure: set with FAILURE.
    took: wall time of the newest step, s, declared work left out.
    inputs: by port, as `Inputs` gives them: of the port's type and immutable.
    outputs: what has been written so far; all of them with SUCCESS.
    """

    def __init__(
        self,
        kind: type[Skill],
        inputs: Mapping[str, Any],
        lease: Lease,
        context: SkillContext,
    ) -> None:
        self.kind = kind
        self.lease = lease
        self.status = Status.IDLE
        self.phase = ""
        self.failure: FailureValue | None = None
        self.took = 0.0
        self._context = context
        self._inputs = dict(inputs)
        self._generator: Run | None = None
        self._waiting: _Pending | None = None
        self.skill: Skill | None = None
        self._host = SkillHost(kind, lease, context)
        self._live = [p for p in kind.ports.values() if p.direction == "out" and p.live]
        self._given: dict[str, Any] = {}

    @property
    def outputs(self) -> dict[str, Any]:
        """Values of the output ports that hold one."""
        if self.skill is None:
            return {}
        values = self.skill.port_values
        outs = (p.name for p in self.kind.ports.values() if p.direction == "out")
        return {name: values[name] for name in outs if name in values}

    def step(self, live_inputs: Mapping[str, Any] | None = None) -> Status:
        """Run to the skill's next `yield`, or to its end."""
        self.took = 0.0
        try:
            if self._generator is None:
                self._generator = self._begin()
            elif live_inputs and self.skill is not None:
                self.skill.port_values.update(live_inputs)
            self._advance(self._generator)
            if self.status is RUNNING:
                self._admit_live_outputs()
        except Failure as failure:
            self._fail(declared(self.kind, failure))
        except Hung as hung:
            self._fail(hung_failure(self.kind, hung))
        except StopRequested:
            raise
        except BaseException as error:  # other people's code: it may raise anything
            self._fail(skill_error(self.kind, error))
        return self.status

    def halt(self) -> None:
        """End the skill at any point and stop its actuators. Calling it twice is safe."""
        generator, self._generator = self._generator, None
        self._waiting = None
        if generator is not None:
            try:
                generator.close()
            except Hung as hung:
                self.failure = hung_failure(self.kind, hung)
            except StopRequested:
                self.lease.end()
                raise
            except BaseException as error:
                self.failure = skill_error(self.kind, error)
        self.lease.end()
        if self.status is RUNNING:
            self.status = Status.IDLE

    def _begin(self) -> Run:
        context = self._context
        self.skill = instance(self.kind, self._inputs, context, self._host)
        return begun(self.skill, self.lease)

    def _advance(self, generator: Run) -> None:
        now = self._context.clock.now()
        pending = self._waiting
        if pending is not None and now < pending.ready_at - CLOCK_SLACK:
            return
        self._waiting = None
        started = time.perf_counter()
        try:
            said = _resume(generator, pending)
            while isinstance(said, Compute) and not said.budget > 0.0:
                said = generator.throw(
                    ValueError(f"compute with a budget of {said.budget} s; thinking is never free")
                )
        except StopIteration:
            self._finish()
            return
        finally:
            self.took = time.perf_counter() - started
        self.status = RUNNING
        if isinstance(said, Compute):
            self._waiting = _compute(said, now)
        elif isinstance(said, str):
            self.phase = self._host.prefix + said
        else:
            raise TypeError(
                f"{self.kind.__name__}.run yielded {said!r}; it may yield a phase's name, or "
                "`yield from compute(...)`"
            )

    def _admit_live_outputs(self) -> None:
        """Live outputs, which others read while the skill runs: a wrong value fails at once.

        Raises:
            Failure: WRONG_TYPE.
        """
        assert self.skill is not None
        values = self.skill.port_values
        for port in self._live:
            value = values.get(port.name, MISSING)
            if value is not MISSING:
                values[port.name] = self._admitted(value, port)

    def _keep_live_outputs(self) -> None:
        """Keep the live outputs of a skill that fails; drop those that do not fit."""
        values = {} if self.skill is None else self.skill.port_values
        for port in self._live:
            if port.name in values:
                try:
                    values[port.name] = self._admitted(values[port.name], port)
                except Failure:
                    del values[port.name]

    def _finish(self) -> None:
        self._generator = None
        try:
            self._check_outputs()
        except Failure as failure:
            self._fail(failure.value)
            return
        except TypeError as error:
            self._fail(skill_error(self.kind, error))
            return
        self.lease.end()
        self.status = SUCCESS

    def _check_outputs(self) -> None:
        assert self.skill is not None
        self.skill.port_values.update(outputs_at_end(self.skill, self._given))

    def _admitted(self, value: Any, port: Port) -> Any:
        """A live output's value; one that is known already is not looked at again."""
        self._given[port.name] = admitted(value, port, self._given)
        return self._given[port.name]

    def _fail(self, failure: FailureValue) -> None:
        generator, self._generator = self._generator, None
        self._waiting = None
        self.failure = failure
        self._keep_live_outputs()
        if generator is not None:
            try:
                generator.close()
            except Hung as hung:
                self.failure = hung_failure(self.kind, hung, cause=failure)
            except StopRequested:
                self.lease.end()
                raise
            except BaseException as error:
                self.failure = skill_error(self.kind, error, cause=failure)
        self.lease.end()
        self.status = FAILURE


@dataclass(frozen=True, slots=True)
class _Pending:
    ready_at: float
    result: Any
    error: Exception | None


def _compute(work: Compute, now: float) -> _Pending:
    try:
        return _Pending(now + work.budget, work.function(), None)
    except Exception as error:
        return _Pending(now + work.budget, None, error)


def _resume(generator: Run, pending: _Pending | None) -> str | Compute:
    if pending is None:
        return next(generator)
    if pending.error is not None:
        return generator.throw(pending.error)
    return generator.send(pending.result)
