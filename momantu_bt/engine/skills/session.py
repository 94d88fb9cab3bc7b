"""One start of one skill: from its inputs to its outputs or its failure, a step a tick."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from momantu_bt.engine.skills.calls import SkillHost
from momantu_bt.engine.skills.errors import declared, hung_failure, skill_error
from momantu_bt.engine.skills.start import (
    Seeds,
    Setup,
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

_ENDED: Any = object()
"""In place of what a skill yields: it has returned. It costs less than a StopIteration."""


class Session:
    """Runs one skill instance. Call `step` once a tick until it no longer returns RUNNING.

    status: of the newest step. phase: what the skill last yielded. failure: set with FAILURE.
    took: wall time of the newest step, s, declared work left out.
    inputs: by port, as `Inputs` gives them: of the port's type and immutable.
    outputs: what has been written so far; all of them with SUCCESS.
    """

    status: Status = Status.IDLE
    phase = ""
    failure: FailureValue | None = None
    took = 0.0
    skill: Skill | None = None
    _generator: Run | None = None
    _waiting: _Pending | None = None
    _given: Mapping[str, Any] = MappingProxyType({})

    def __init__(self, setup: Setup, inputs: Mapping[str, Any], seeds: Seeds) -> None:
        self._setup = setup
        self._inputs = inputs
        self._host = SkillHost(setup, seeds)

    @property
    def outputs(self) -> dict[str, Any]:
        """Values of the output ports that hold one."""
        if self.skill is None:
            return {}
        values = self.skill.port_values
        outs = self._setup.signature.outputs
        return {port.name: values[port.name] for port in outs if port.name in values}

    def step(self, live_inputs: Mapping[str, Any] | None = None) -> Status:
        """Run to the skill's next `yield`, or to its end."""
        setup, kind, generator = self._setup, self._setup.kind, self._generator
        try:
            if generator is None:
                self.skill = instance(setup, self._inputs, self._host)
                generator = self._generator = begun(self.skill, setup.robot)
            elif live_inputs and self.skill is not None:
                self.skill.port_values.update(live_inputs)
            self._advance(generator)
            if self.status is RUNNING and setup.signature.live_outputs:
                self._admit_live_outputs()
        except Failure as failure:
            self._fail(declared(kind, failure))
        except Hung as hung:
            self._fail(hung_failure(kind, hung))
        except StopRequested:
            raise
        except BaseException as error:  # other people's code: it may raise anything
            self._fail(skill_error(kind, error))
        return self.status

    def halt(self) -> None:
        """End the skill at any point and stop its actuators. Calling it twice is safe."""
        generator, self._generator = self._generator, None
        self._waiting = None
        if generator is not None:
            try:
                generator.close()
            except Hung as hung:
                self.failure = hung_failure(self._setup.kind, hung)
            except StopRequested:
                self._setup.robot.end()
                raise
            except BaseException as error:
                self.failure = skill_error(self._setup.kind, error)
        self._setup.robot.end()
        if self.status is RUNNING:
            self.status = Status.IDLE

    def _advance(self, generator: Run) -> None:
        pending = self._waiting
        if pending is not None:
            if self._now() < pending.ready_at - CLOCK_SLACK:
                self.took = 0.0
                return
            self._waiting = None
        started = time.perf_counter()
        try:
            said = next(generator, _ENDED) if pending is None else _resume(generator, pending)
            while isinstance(said, Compute) and not said.budget > 0.0:
                said = generator.throw(
                    ValueError(f"compute with a budget of {said.budget} s; thinking is never free")
                )
        except StopIteration:
            said = _ENDED
        finally:
            self.took = time.perf_counter() - started
        if said is _ENDED:
            self._finish()
            return
        self.status = RUNNING
        if isinstance(said, Compute):
            self._waiting = _compute(said, self._now())
        elif isinstance(said, str):
            self.phase = self._host.prefix + said
        else:
            raise TypeError(
                f"{self._setup.kind.__name__}.run yielded {said!r}; "
                "it may yield a phase's name, or `yield from compute(...)`"
            )

    def _now(self) -> float:
        return self._setup.context.clock.now()

    def _admit_live_outputs(self) -> None:
        """Live outputs, which others read while the skill runs: a wrong value fails at once.

        Raises:
            Failure: WRONG_TYPE.
        """
        assert self.skill is not None
        values = self.skill.port_values
        for port in self._setup.signature.live_outputs:
            value = values.get(port.name, MISSING)
            if value is not MISSING:
                values[port.name] = self._admitted(value, port)

    def _keep_live_outputs(self) -> None:
        """Keep the live outputs of a skill that fails; drop those that do not fit."""
        values = {} if self.skill is None else self.skill.port_values
        for port in self._setup.signature.live_outputs:
            if port.name in values:
                try:
                    values[port.name] = self._admitted(values[port.name], port)
                except Failure:
                    del values[port.name]

    def _finish(self) -> None:
        self._generator = None
        skill, setup = self.skill, self._setup
        assert skill is not None
        try:
            if setup.signature.outputs:
                skill.port_values.update(outputs_at_end(skill, setup, self._given))
        except Failure as failure:
            self._fail(failure.value)
            return
        except TypeError as error:
            self._fail(skill_error(setup.kind, error))
            return
        setup.robot.end()
        self.status = SUCCESS

    def _admitted(self, value: Any, port: Port) -> Any:
        """A live output's value; one that is known already is not looked at again."""
        found = admitted(value, port, self._given)
        self._given = {**self._given, port.name: found}
        return found

    def _fail(self, failure: FailureValue) -> None:
        generator, self._generator = self._generator, None
        self._waiting = None
        self.failure = failure
        if self._setup.signature.live_outputs:
            self._keep_live_outputs()
        if generator is not None:
            try:
                generator.close()
            except Hung as hung:
                self.failure = hung_failure(self._setup.kind, hung, cause=failure)
            except StopRequested:
                self._setup.robot.end()
                raise
            except BaseException as error:
                self.failure = skill_error(self._setup.kind, error, cause=failure)
        self._setup.robot.end()
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


def _resume(generator: Run, pending: _Pending) -> str | Compute:
    if pending.error is not None:
        return generator.throw(pending.error)
    return generator.send(pending.result)
