"""What a record shows at each instant is what the run showed, word for word."""

from __future__ import annotations

from hypothesis import HealthCheck, given, reject, settings

from momantu_bt.engine.status import RUNNING
from momantu_bt.record.text.lines import running_text, tree_lines
from momantu_bt.replay.timeline import Timeline
from momantu_bt.tree.load import TreeError
from tests.framework.replay.test_recheck import trees_at_work


class Watching:
    """Keeps what the run shows in each tick."""

    def __init__(self, run):
        self.seen = [self._seen(run)]

    def ticked(self, run):
        self.seen.append(self._seen(run))

    def close(self):
        pass

    def _seen(self, run):
        root, board = run.built.root, run.built.board
        return (
            tree_lines(root),
            running_text(root),
            [(n.shown, n.label, n.note if n.shown is RUNNING else "") for n in run.built.nodes],
            board.values(),
        )


@settings(max_examples=40, suppress_health_check=list(HealthCheck), deadline=None)
@given(text=trees_at_work())
def test_every_instant_of_a_record_is_that_of_the_run(recorded, text):
    watching = []

    def watch(run):
        watching.append(Watching(run))
        return watching

    try:
        record = recorded(text, max_time=1.0, watch=watch)
    except TreeError:
        reject()
    timeline = Timeline(record)
    assert len(timeline) == len(watching[0].seen)
    for index, (lines, running, nodes, board) in enumerate(watching[0].seen):
        moment = timeline.moment(index)
        assert tree_lines(moment.root) == lines
        assert running_text(moment.root) == running
        found = [(n.shown, n.label, n.note if n.shown is RUNNING else "") for n in moment.nodes]
        assert found == nodes
        assert {k: v for k, v in moment.board.items() if "/" not in k} == board
