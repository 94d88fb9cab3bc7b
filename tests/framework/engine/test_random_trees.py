"""Invariants of every control node and decorator, on random trees of scripted leaves.

A leaf's script is made of rounds: K, or some R and then S or F. A tree is drawn as plain data and
built afresh for each run, so that runs can be compared.
"""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from momantu_bt.engine.build import Built
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.interrupts import Interrupts
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING
from momantu_bt.nodes.branches import IfThenElse, WhileDoElse
from momantu_bt.nodes.fallbacks import AsyncFallback, Fallback, RoundRobin
from momantu_bt.nodes.forcing import ElseFail, ForceFailure, ForceSuccess, Inverter
from momantu_bt.nodes.loops import (
    KeepRunningUntilFailure,
    Repeat,
    RetryUntilSuccessful,
    RunOnce,
)
from momantu_bt.nodes.parallel import Parallel, ParallelAll
from momantu_bt.nodes.pipelines import NonblockingSequence, PipelineSequence
from momantu_bt.nodes.queues import LoopInt
from momantu_bt.nodes.rates import RateController, SingleTrigger
from momantu_bt.nodes.reactive import ReactiveFallback, ReactiveSequence
from momantu_bt.nodes.recover import Handle, Recover
from momantu_bt.nodes.recovery_node import RecoveryNode
from momantu_bt.nodes.sequences import AsyncSequence, Sequence, SequenceWithMemory
from momantu_bt.nodes.switch import Switch2
from momantu_bt.nodes.timing import Delay, Timeout
from momantu_bt.nodes.try_catch import TryCatch
from momantu_bt.world_plugins import NoWorld

ANY_NUMBER = (
    Sequence,
    AsyncSequence,
    ReactiveSequence,
    Fallback,
    AsyncFallback,
    ReactiveFallback,
    PipelineSequence,
    NonblockingSequence,
    Handle,
)
TWO = (RecoveryNode,)
TWO_OR_THREE = (IfThenElse, WhileDoElse, TryCatch)
SIDE_BY_SIDE = (Parallel, ParallelAll, WhileDoElse, PipelineSequence, NonblockingSequence)
ONE = (Inverter, ForceSuccess, ForceFailure, KeepRunningUntilFailure, SingleTrigger)
PORTS = {
    ElseFail: {"code": st.just("LOST"), "message": st.just("")},
    Parallel: {"success_count": st.sampled_from([-1, 1]), "failure_count": st.just(1)},
    ParallelAll: {"max_failures": st.just(1)},
    Recover: {"attempts": st.integers(1, 3)},
    Repeat: {"cycles": st.integers(1, 3)},
    RetryUntilSuccessful: {"attempts": st.integers(1, 3)},
    Timeout: {"duration": st.sampled_from([0.1, 0.2])},
    Delay: {"duration": st.sampled_from([0.0, 0.1])},
    RunOnce: {"then_skip": st.booleans()},
    RoundRobin: {"wrap_around": st.booleans()},
    RecoveryNode: {"number_of_retries": st.integers(0, 2)},
    TryCatch: {"catch_on_halt": st.booleans()},
    RateController: {"hz": st.sampled_from([5.0, 20.0])},
    Switch2: {"variable": st.sampled_from(["a", "b", "c"])},
    LoopInt: {"queue": st.sampled_from([(), (1,), (1, 2)])},
}
REMEMBERING = (SequenceWithMemory, RoundRobin, RunOnce)
"""Nodes that keep something over their end or a halt, and are meant to."""
GOING_ON = (LoopInt, RateController, SingleTrigger)
"""Nodes that go on after an end that nobody collects, as `if` without `else` leaves its own."""
FAILING_THEMSELVES = (Inverter, ForceFailure, Parallel, Delay, SingleTrigger)
"""Of a delay a timeout says that it was waiting."""

ROUNDS = st.sampled_from(["K", "S", "F", "RS", "RF", "RRS", "RRF"])
SCRIPTS = st.builds(
    lambda rounds, last: "".join(rounds) + last,
    st.lists(ROUNDS, max_size=3),
    st.sampled_from(["S", "F", "R", "K"]),
)


@st.composite
def above(draw, kids, kinds):
    """A node of one of some kinds: (kind, children, ports)."""
    kind = draw(st.sampled_from(kinds))
    if kind in TWO_OR_THREE:
        fewest, most = 2, 3
    elif kind in TWO:
        fewest, most = 2, 2
    elif kind is Switch2:
        fewest, most = 3, 3
    elif issubclass(kind, Decorator):
        fewest, most = 1, 1
    else:
        fewest, most = 1, 3
    children = draw(st.lists(kids, min_size=fewest, max_size=most))
    ports = {name: draw(values) for name, values in PORTS.get(kind, {}).items()}
    return (kind, children, ports)


def trees(*left_out):
    kinds = [*ANY_NUMBER, *TWO_OR_THREE, *ONE, *PORTS, *REMEMBERING]
    kinds = [kind for kind in dict.fromkeys(kinds) if kind not in left_out]
    return above(st.recursive(SCRIPTS, lambda kids: above(kids, kinds), max_leaves=7), kinds)


class Plant:
    """Builds a drawn tree; every node has a name of its own."""

    def __init__(self, bench, spec):
        self.bench = bench
        self.leaves = []
        self.count = 0
        self.root = self.node(spec)
        self.nodes = (self.root, *self.root.below)
        for index, node in enumerate(self.nodes):
            node.index = index
            node.depth = 0 if node.above is None else node.above.depth + 1
        self.by_name = {node.name: node for node in self.nodes}

    def node(self, spec):
        self.count += 1
        name = f"n{self.count}"
        if isinstance(spec, str):
            leaf = self.bench.leaf(spec, name)
            self.leaves.append(leaf)
            return leaf
        kind, children, ports = spec
        kids = [self.node(child) for child in children]
        if kind is Switch2:
            ports = {**ports, "case_1": "a", "case_2": "b"}
        answers = ()
        if issubclass(kind, Recover | Handle):
            answers = [(("any",), kid) for kid in kids[1:]] or [(("X",), None)]
        model = self.bench.model(kind.spec.type, name)
        return kind(self.bench.parts(model, kids, answers, **ports))

    def running(self):
        return [leaf for leaf in self.leaves if leaf.state is RUNNING]

    def trace(self, ticks=12):
        """What each tick returned and which statuses changed below the root, until an end."""
        found = []
        for _ in range(ticks):
            letter = self.bench.tick(self.root)
            changes = [(c.node.name, c.status, c.note) for c in self.bench.context.changes]
            below = [c for c in changes if c[1] is not IDLE and c[0] != self.root.name]
            found.append((letter, below))
            if letter != "R":
                break
        return found

    def rewind(self):
        for leaf in self.leaves:
            leaf.given = 0


CHECKS = settings(max_examples=70, suppress_health_check=[HealthCheck.too_slow])


@CHECKS
@given(spec=trees(*SIDE_BY_SIDE))
def test_where_nothing_is_side_by_side_at_most_one_leaf_is_running(new_bench, spec):
    plant = Plant(new_bench(), spec)
    for _ in range(12):
        letter = plant.bench.tick(plant.root)
        assert letter in "RSFK"
        assert len(plant.running()) <= 1
        if letter != "R":
            break


@CHECKS
@given(spec=trees())
def test_an_end_leaves_nothing_running(new_bench, spec):
    plant = Plant(new_bench(), spec)
    letter = plant.bench.ticks(plant.root, most=15)[-1]
    halts = [leaf.halts for leaf in plant.leaves]
    if letter == "R":
        return
    assert plant.running() == []
    assert not any(node.shown is RUNNING for node in plant.nodes)
    plant.root.reset()
    assert [leaf.halts for leaf in plant.leaves] == halts
    assert not any(node.state is RUNNING for node in plant.nodes)


@CHECKS
@given(spec=trees(), ticks=st.lists(st.integers(0, 6), min_size=1, max_size=3))
def test_every_leaf_that_was_started_ends_once_however_often_its_tree_is_halted(
    new_bench, spec, ticks
):
    plant = Plant(new_bench(), spec)
    for before_halt in ticks:
        for _ in range(before_halt):
            plant.bench.tick(plant.root)
        plant.root.reset()
        halts = [leaf.halts for leaf in plant.leaves]
        plant.root.reset()
        assert [leaf.halts for leaf in plant.leaves] == halts
        assert [leaf.runs for leaf in plant.leaves] == [ends(leaf) for leaf in plant.leaves]
        assert plant.root.state is IDLE
        assert not any(RUNNING in (node.state, node.shown) for node in plant.nodes)


def ends(leaf):
    """How often a leaf has returned anything but RUNNING, or was halted."""
    given = (leaf.script[min(i, len(leaf.script) - 1)] for i in range(leaf.given))
    return leaf.halts + sum(status is not RUNNING for status in given)


@CHECKS
@given(spec=trees(*REMEMBERING, *GOING_ON), ticks=st.integers(1, 8))
def test_after_a_halt_or_an_end_a_tree_runs_as_if_for_the_first_time(new_bench, spec, ticks):
    fresh, used = Plant(new_bench(), spec), Plant(new_bench(), spec)
    for _ in range(ticks):
        if used.bench.tick(used.root) != "R":
            break
    used.root.reset()
    used.rewind()
    assert used.trace() == fresh.trace()


FORGETTING = [
    kind
    for kind in dict.fromkeys((*ANY_NUMBER, *TWO_OR_THREE, *ONE, *PORTS))
    if kind not in REMEMBERING
]


@pytest.mark.parametrize("kind", FORGETTING)
@settings(max_examples=25)
@given(data=st.data(), ticks=st.integers(1, 4))
def test_a_halted_node_remembers_nothing(new_bench, kind, data, ticks):
    working = st.sampled_from(["RRS", "RRF", "RSRF", "RFRS", "SRS", "FRF"])
    spec = data.draw(above(working, [kind]))
    fresh, used = Plant(new_bench(), spec), Plant(new_bench(), spec)
    for _ in range(ticks):
        if used.bench.tick(used.root) != "R":
            break
    used.root.reset()
    used.rewind()
    assert used.trace() == fresh.trace()


@CHECKS
@given(spec=trees())
def test_a_failure_leads_to_the_node_that_failed_of_its_own(new_bench, spec):
    plant = Plant(new_bench(), spec)
    if not plant.bench.ticks(plant.root, most=15).endswith("F"):
        return
    links = list(plant.root.failure.chain())
    assert all(link.node in plant.by_name for link in links)
    last = plant.by_name[links[-1].node]
    assert last in plant.leaves or isinstance(last, FAILING_THEMSELVES)
    assert all(beside.node in plant.by_name for link in links for beside in link.beside)


@CHECKS
@given(spec=trees())
def test_what_is_counted_adds_up(new_bench, spec):
    plant = Plant(new_bench(), spec)
    plant.bench.ticks(plant.root, most=10)
    plant.root.reset()
    for node in plant.nodes:
        assert node.failures <= node.ticks
        assert node.runs <= node.ticks
        assert 0.0 <= node.seconds <= plant.bench.clock.now() + 1e-9
        assert all(child.ticks == 0 or node.ticks > 0 for child in node.kids)
    assert all(leaf.ticks == leaf.given for leaf in plant.leaves)


class Traced:
    """An observer that keeps what a fingerprint is made of."""

    def __init__(self):
        self.ticks = []

    def ticked(self, run):
        self.ticks.append([(c.node.index, c.status) for c in run.context.changes])

    def close(self):
        pass


def executed(new_bench, spec, prepare=lambda plant: None):
    bench, seen = new_bench(), Traced()
    plant = Plant(bench, spec)
    prepare(plant)
    stepper = NoWorld()
    bench.context.clock = stepper
    built = Built(plant.root, plant.nodes, bench.board)
    run = Executor(built, bench.context, stepper, max_time=1.0)
    run.show_to(seen)
    return plant, run.run(Interrupts()), run.fingerprint.hexdigest(), seen.ticks


@CHECKS
@given(left=trees(), right=trees(), same=st.booleans())
def test_fingerprints_are_equal_exactly_when_the_runs_are(new_bench, left, right, same):
    first = executed(new_bench, left)
    second = executed(new_bench, left if same else right)
    writes_nothing = not any(
        isinstance(node, Recover | Handle) for node in (*first[0].nodes, *second[0].nodes)
    )
    if same:
        assert first[2:] == second[2:]
    elif writes_nothing:
        assert (first[2] == second[2]) == (first[3] == second[3])


class Broken(Exception):
    """Raised by the tests' leaves: what no node may catch."""


def breaking(which, at):
    """Make one leaf raise at one of its steps."""

    def prepare(plant):
        leaf = plant.leaves[which % len(plant.leaves)]
        step = leaf.step

        def broken():
            if leaf.given == at:
                raise Broken(leaf.name)
            return step()

        leaf.step = broken

    return prepare


@CHECKS
@given(spec=trees(), which=st.integers(0, 6), at=st.integers(0, 4))
def test_after_an_exception_in_any_tick_no_status_is_stale(new_bench, spec, which, at):
    plant, ending, _, _ = executed(new_bench, spec, breaking(which, at))
    assert not any(RUNNING in (node.state, node.shown) for node in plant.nodes)
    if ending.status == "ERROR":
        assert "Broken" in ending.error
    else:
        assert ending.status in ("SUCCESS", "FAILURE")


@pytest.mark.parametrize("kind", [Sequence, Fallback, Parallel, Recover, Timeout, IfThenElse])
def test_an_exception_is_not_taken_for_a_failure(new_bench, kind):
    ports = {name: -1 if name == "success_count" else 1 for name in PORTS.get(kind, {})}
    kids = ["RS"] if kind is Timeout else ["RS", "RS"]
    _, ending, _, _ = executed(new_bench, (kind, kids, ports), breaking(0, 1))
    assert ending.status == "ERROR"
    assert ending.failure is None


@CHECKS
@given(spec=trees())
def test_the_end_of_a_run_is_its_roots(new_bench, spec):
    plant, ending, _, _ = executed(new_bench, spec)
    if ending.status == "FAILURE":
        assert ending.failure is not None
        if ending.failure.code != "TIMEOUT":
            assert plant.root.shown is FAILURE
    else:
        assert ending.failure is None
    assert not any(RUNNING in (node.state, node.shown) for node in plant.nodes)
