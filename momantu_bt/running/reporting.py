"""Makes the report of a run that has ended."""

from __future__ import annotations

from momantu_bt.engine.ending import Ending
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.skill_leaf import SkillLeaf
from momantu_bt.record.report import FaultReport, NodeReport, Report
from momantu_bt.record.versions import versions


def report_of(
    tree: str,
    executor: Executor,
    ending: Ending,
    started: float,
    faults: tuple[FaultReport, ...] = (),
) -> Report:
    """The report of a run that has ended.

    tree: the tree's file. started: wall time before the first tick, s.
    """
    world, verdict = executor.world, ending.verdict
    return Report(
        tree=tree,
        world=None if world is None else world.name,
        robot=None if world is None else world.robot.description.name,
        seed=executor.context.seed,
        status=ending.status,
        success=None if verdict is None else verdict.success,
        failure=ending.failure,
        unmet=() if verdict is None else verdict.unmet,
        measures={} if verdict is None else verdict.measures,
        sim_time_s=ending.sim_time,
        wall_time_s=ending.wall_time,
        start_time_s=started,
        ticks=ending.ticks,
        blackboard=executor.built.board.values(),
        nodes=tuple(_node_report(node) for node in executor.built.nodes),
        fingerprint=executor.fingerprint.hexdigest(),
        versions=versions(),
        error=ending.error,
        incidents=() if verdict is None else verdict.incidents,
        demands=() if verdict is None else verdict.demands,
        causes={} if verdict is None else verdict.causes,
        faults=faults,
        interrupted_by=ending.interrupted_by,
    )


def _node_report(node: TreeNode) -> NodeReport:
    slow = node if isinstance(node, SkillLeaf) else None
    return NodeReport(
        name=node.name,
        type=node.model.target or node.model.type,
        place=node.place,
        ticks=node.ticks,
        runs=node.runs,
        failures=node.failures,
        seconds=round(node.seconds, 9),
        slow_ticks=0 if slow is None else slow.slow_steps,
        slowest_s=0.0 if slow is None else round(slow.slowest, 4),
        conditions={} if node.conditions is None else node.conditions.counts,
        answered=node.answered,
    )
