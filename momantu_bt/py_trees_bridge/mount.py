"""A tree file as one behaviour of a py_trees tree."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status as PyTreesStatus

from momantu_bt.engine.executor import Executor
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.person import Scripted
from momantu_bt.engine.status import RUNNING
from momantu_bt.py_trees_bridge.view import PY_TREES_STATUS, view
from momantu_bt.record.text.lines import tree_lines
from momantu_bt.running.launch import assemble
from momantu_bt.running.options import RunOptions
from momantu_bt.running.prepare import Prepared, prepare
from momantu_bt.tree.files.given_text import AnyTree, tree_source
from momantu_bt.tree.registry import Registry
from momantu_bt.world import World


def as_behaviour(
    tree: AnyTree,
    *,
    name: str | None = None,
    world: str | World | None = None,
    robot: str | None = None,
    seed: int = 0,
    values: Mapping[str, Any] | None = None,
    answers: Iterable[str | bool] = (),
    registry: Registry | None = None,
) -> TreeBehaviour:
    """A checked tree for a py_trees tree.

    name: of the behaviour; the main tree's unless given. The tree and the other arguments are those
    of `momantu_bt.run`. The tree is read and checked here.

    Raises:
        TreeNotFound: there is no such tree.
        TreeError: the tree has errors; all of them are in it.
    """
    options = RunOptions(
        world=world, robot=robot, seed=seed, values=values or {}, person=Scripted(answers)
    )
    return TreeBehaviour(name, prepare(tree_source(tree), options, registry))


class TreeBehaviour(Behaviour):
    """Each tick is one tick of the tree: 0.05 s of its clock, and a step of its world.

    Each start is a new run that begins with the values of the file. A world given by name is
    opened again at each start; an open world continues as it is. `terminate` halts the tree and
    stops the robot.
    """

    def __init__(self, name: str | None, prepared: Prepared) -> None:
        super().__init__(name or prepared.document.main)
        self._prepared = prepared
        self._stack = ExitStack()
        self._run: Executor | None = None

    @property
    def values(self) -> Mapping[str, Any]:
        """Keys of the root's board that have a value; empty before the first start."""
        return {} if self._run is None else self._run.built.board.values()

    def shown(self) -> Behaviour | None:
        """The tree of the newest run as py_trees behaviours, for displays; None before it."""
        return None if self._run is None else view(self._run.built.root)

    def initialise(self) -> None:
        """Begin a run.

        Raises:
            LaunchError: the tree needs a world, or a service that is not installed.
            WorldError: the world could not start.
        """
        self._stack.close()
        self._run = assemble(self._prepared, self._stack)
        self._run.begin()

    def update(self) -> PyTreesStatus:
        """One tick. py_trees has no SKIPPED, so it becomes SUCCESS: there was nothing to do.

        If a tick raises, the robot is stopped before the error goes on.
        """
        run = self._run
        assert run is not None
        try:
            status = run.tick()
        except BaseException:
            run.stop()
            raise
        failure = run.built.root.failure
        self.feedback_message = _at_work(run.built.root) if failure is None else str(failure)
        found = PY_TREES_STATUS[status]
        return PyTreesStatus.SUCCESS if found is PyTreesStatus.INVALID else found

    def terminate(self, new_status: PyTreesStatus) -> None:
        """Halt what runs, and stop the robot."""
        if self._run is not None:
            self._run.stop()

    def shutdown(self) -> None:
        """Halt what still runs; close the world, where this behaviour opened it."""
        if self.status is PyTreesStatus.RUNNING:
            self.stop(PyTreesStatus.INVALID)
        self._stack.close()


def _at_work(root: TreeNode) -> str:
    """The innermost node that runs, in one line; empty when the tree has ended."""
    running = [line.text for line in tree_lines(root) if line.status == RUNNING.value]
    return running[-1] if running else ""
