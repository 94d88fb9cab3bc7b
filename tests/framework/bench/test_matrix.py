"""What becomes of a fault: each way an episode can end, and the table of them."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from momantu_bt.bench.reports.matrix import Matrix, matrix_text
from momantu_bt.bench.rows.outcome import Outcome, outcome
from momantu_bt.fault_kind import FaultKind, Where
from momantu_bt.faults.matrix import Row as Demand
from momantu_bt.faults.matrix import row_of, rows_like
from momantu_bt.faults.spec import parse_fault

DEAD = row_of(parse_fault("camera.dead"))
KILLED = row_of(parse_fault("process.killed"))


def failure(code: str, cause: Any = None, beside: Any = ()) -> dict[str, Any]:
    return {"code": code, "cause": cause, "beside": list(beside)}


def row(demand: Demand = DEAD, seed: int = 0, **more: Any) -> dict[str, Any]:
    """A row of a run that succeeded, with its fault at 10 s."""
    return {
        "fault": demand.fault,
        "seed": seed,
        "ended": "report",
        "exit_code": -9,
        "status": "SUCCESS",
        "success": True,
        "failure": None,
        "incidents": [],
        "faults": [{"fault": demand.fault, "began": 10.0, "ended": 15.0}],
        **more,
    }


def failed(code: str, **more: Any) -> dict[str, Any]:
    return row(status="FAILURE", success=False, failure=failure(code, **more))


def incident(time: float) -> dict[str, Any]:
    return {"time": time, "kind": "force", "sentence": "it pushed", "value": 200.0}


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        (row(), Outcome.RECOVERED),
        (row(success=None), Outcome.RECOVERED),
        (row(success=False), Outcome.UNSAFE),
        (failed("SENSOR_DEAD"), Outcome.SAFE),
        (failed("TIMEOUT", cause=failure("SENSOR_DEAD")), Outcome.SAFE),
        (failed("NO_PLAN", beside=[failure("X", cause=failure("SENSOR_DEAD"))]), Outcome.SAFE),
        (failed("NO_PLAN"), Outcome.WRONG_REASON),
        (row(status="ERROR", success=None), Outcome.WRONG_REASON),
        (row(ended="hung"), Outcome.UNSAFE),
        (row(ended="crashed"), Outcome.UNSAFE),
        (row(ended="killed"), Outcome.UNSAFE),
        (row(KILLED, ended="killed"), Outcome.SAFE),
        (row(KILLED, ended="hung", exit_code=1), Outcome.SAFE),
        (row(KILLED, ended="hung"), Outcome.UNSAFE),
        (row(ended="impossible"), Outcome.IMPOSSIBLE),
        (row(faults=[{"fault": "camera.dead", "began": None, "ended": None}]), Outcome.NOT_MET),
    ],
)
def test_how_an_episode_ended_is_what_became_of_its_fault(
    told: dict[str, Any], expected: Outcome
) -> None:
    demand = row_of(parse_fault(told["fault"]))
    assert outcome(told, demand) is expected


def test_danger_counts_once_the_fault_could_be_noticed_however_it_ended() -> None:
    at = 10.0 + DEAD.notice
    for ending in (row(), failed("SENSOR_DEAD"), failed("NO_PLAN")):
        before = outcome({**ending, "incidents": [incident(2.0), incident(at)]}, DEAD)
        assert before is outcome(ending, DEAD)
        later = {**ending, "incidents": [incident(2.0), incident(at + 0.01)]}
        assert outcome(later, DEAD) is Outcome.UNSAFE


def _kind(name: str, recoverable: bool) -> Demand:
    component, mode = name.split(".")
    kind = FaultKind(component, mode, "…", Where.ROBOT, (), 5.0, recoverable)
    return Demand(name, kind, recoverable)


def test_the_pooled_rate_is_of_recoverable_faults_that_happened() -> None:
    demands = [_kind("a.can", True), _kind("b.can", True), _kind("c.cannot", False)]
    rows = []
    for demand, good in itertools.product(demands, (True, True, False)):
        rows.append(row(demand, len(rows), success=good))
    unmet = [{"fault": "x", "began": None, "ended": None}]
    rows.append(row(demands[0], 20, faults=unmet))
    rows.append(row(demands[1], 21, ended="impossible", output="b.can: no such thing here"))
    matrix = Matrix.of(demands, rows)
    assert matrix.pooled == (4, 6)
    told = matrix.as_dict()
    assert told["recoverable"]["episodes"] == 6
    assert [line["unsafe"] for line in told["faults"]] == [[2], [5], [8]]
    for line in matrix.lines:
        mine = [each for each in rows if each["fault"] == line.demand.fault]
        assert sum(map(len, line.seeds.values())) == len(mine)
    text = matrix_text(matrix)
    assert "4 of 6, 66.7 %" in text
    assert "unsafe: a.can on seeds 2" in text
    assert "cannot happen on seeds 21: b.can: no such thing here" in text


def test_a_fault_that_can_nowhere_happen_has_no_line_but_a_reason() -> None:
    demand = _kind("a.can", True)
    why = {"ended": "impossible", "output": "a.can: there is no a"}
    text = matrix_text(Matrix.of([demand], [row(demand, seed, **why) for seed in range(3)]))
    assert "cannot happen: a.can: there is no a" in text
    assert "a.can  " not in text
    assert "no episode yet" in text


def test_every_row_of_the_catalogue_is_judged_by_its_own_demand() -> None:
    for demand in rows_like("all"):
        same = row_of(parse_fault(demand.fault))
        assert (same.kind, same.recoverable) == (demand.kind, demand.recoverable)
        for code in demand.reasons:
            assert outcome({**failed(code), "fault": demand.fault}, demand) is Outcome.SAFE
