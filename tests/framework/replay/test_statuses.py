"""What a record shows at each instant is what the run showed."""

from __future__ import annotations

from pathlib import Path

from hypothesis import HealthCheck, given, reject, settings

import momantu_bt
from momantu_bt.record.recording import ChangeRecord, NodeInfo
from momantu_bt.replay.statuses import Statuses
from momantu_bt.tree.load import TreeError
from momantu_bt.tree.registry import Registry
from tests.framework.tree.test_soundness import trees


class Comparing:
    """An observer that brings statuses forward beside the run's own."""

    def __init__(self, run):
        self.statuses = Statuses(
            [
                NodeInfo(n.index, n.name, n.model.type, n.place, n.depth, _parent(n), n.label)
                for n in run.built.nodes
            ]
        )
        self.wrong = []

    def ticked(self, run):
        changes = run.context.changes
        self.statuses.tick(
            [ChangeRecord(c.node.index, c.status.value, c.note, c.failure) for c in changes]
        )
        for node, found in zip(run.built.nodes, self.statuses.shown(), strict=True):
            if node.shown is not found:
                self.wrong.append((run.context.tick, node.label, node.shown, found))

    def close(self):
        pass


def _parent(node):
    return None if node.above is None else node.above.index


@settings(max_examples=100, suppress_health_check=list(HealthCheck), deadline=None)
@given(trees())
def test_statuses_found_from_changes_are_the_runs(tmp_path_factory, text):
    path: Path = tmp_path_factory.getbasetemp() / "shown.yaml"
    path.write_text(text, encoding="utf-8")
    seen = []

    def watch(run):
        seen.append(Comparing(run))
        return seen

    try:
        momantu_bt.run(path, world="none", max_time=1.0, registry=Registry(), watch=watch)
    except TreeError:
        reject()
    assert seen[0].wrong == []
