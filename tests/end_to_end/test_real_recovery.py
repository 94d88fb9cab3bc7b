"""What goes wrong in the world is mended in the world: the can is stolen from the hand, once."""

from typing import Any

import pytest

from momantu_bt import run
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.status import RUNNING


class Thief:
    """Puts the can back on its table, elsewhere, soon after it was first carried away."""

    def __init__(self, executor: Executor) -> None:
        self.stolen_at: float | None = None
        self._simulator: Any = executor.world.simulator  # type: ignore[union-attr]
        self._start = self._simulator.truth.pose("can")

    def ticked(self, executor: Executor) -> None:
        if self.stolen_at is not None:
            return
        running = [n.model.type for n in executor.built.nodes if n.state is RUNNING]
        lifted = self._simulator.truth.pose("can").position[2] - self._start.position[2]
        if "reset_pose" in running and lifted > 0.1:
            self.stolen_at = executor.context.now
            self._simulator.put("can", self._start)

    def close(self) -> None: ...


@pytest.mark.parametrize("seed", [3])
def test_a_can_that_is_lost_from_the_hand_is_fetched_again(seed: int) -> None:
    thieves: list[Thief] = []

    def watch(executor: Executor) -> list[Thief]:
        thieves.append(Thief(executor))
        return thieves

    report = run("bring_object", seed=seed, watch=watch)
    assert thieves[0].stolen_at is not None
    assert report.status == "SUCCESS", report.failure
    assert report.success, report.unmet
    picks = [node for node in report.nodes if node.type == "pick"]
    assert sum(node.runs for node in picks) == 2
