"""What each node showed, from the journal of changes.

The journal has a line for every result that differs from the one before. It has a line for the
same result too if the node above has begun a new run since. It has no line when a node becomes
IDLE because the node above has begun a new run: this module finds that out.
"""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.engine.status import IDLE, RUNNING, SKIPPED, Status
from momantu_bt.failure import FailureValue
from momantu_bt.record.recording import ChangeRecord, NodeInfo


class Statuses:
    """The newest result of each node, by index. Each change updates it.

    notes, failures: also by index. A note counts while its node is RUNNING.
    """

    def __init__(self, nodes: Sequence[NodeInfo]) -> None:
        self._above = [node.parent for node in nodes]
        self._last: list[Status] = [IDLE] * len(nodes)
        self._runs = [0] * len(nodes)
        self._seen_in = [0] * len(nodes)
        self._at_work = [False] * len(nodes)
        self.notes = [""] * len(nodes)
        self.failures: list[FailureValue | None] = [None] * len(nodes)

    def copy(self) -> Statuses:
        """A copy that can be advanced on its own."""
        twin = Statuses(())
        twin._above = self._above
        twin._last, twin._runs = list(self._last), list(self._runs)
        twin._seen_in, twin._at_work = list(self._seen_in), list(self._at_work)
        twin.notes, twin.failures = list(self.notes), list(self.failures)
        return twin

    def tick(self, changes: Sequence[ChangeRecord]) -> None:
        """Apply the changes of one tick."""
        begun: list[int] = []
        for change in changes:
            self._change(change, begun)
        for node in begun:
            self._at_work[node] = self._last[node] is RUNNING

    def shown(self) -> list[Status]:
        """The shown status of each node: IDLE below a node that has restarted."""
        found: list[Status] = []
        stale: list[bool] = []
        for node, above in enumerate(self._above):
            old = above is not None and (stale[above] or self._seen_in[node] != self._runs[above])
            stale.append(old)
            found.append(IDLE if old else self._last[node])
        return found

    def _change(self, change: ChangeRecord, begun: list[int]) -> None:
        node, status = change.node, Status(change.status)
        above = self._above[node]
        if status is not IDLE and above is not None:
            self._work(above, begun)
            if self._is_repeated(node, status, above):
                self._runs[above] += 1
        if status not in (IDLE, SKIPPED):
            self._work(node, begun)
        self._at_work[node] = status is RUNNING
        self._last[node] = status
        self._seen_in[node] = 0 if above is None else self._runs[above]
        self.notes[node] = change.note
        self.failures[node] = change.failure

    def _work(self, node: int | None, begun: list[int]) -> None:
        """Note that a node is being ticked. If it was not at work, it has begun a new run."""
        while node is not None and not self._at_work[node]:
            self._at_work[node] = True
            self._runs[node] += 1
            begun.append(node)
            node = self._above[node]

    def _is_repeated(self, node: int, status: Status, above: int) -> bool:
        """Whether a change repeats the current status: then the node above has restarted."""
        again = status is not RUNNING and status is self._last[node]
        return again and self._seen_in[node] == self._runs[above]
