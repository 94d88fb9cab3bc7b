"""Recover, Handle, ForEach, Fail: what happens when something fails, and what people are told."""

from __future__ import annotations

import pytest

from momantu_bt.record.text.failure import failure_line
from momantu_bt.skill import Failure, In, Out, Run, Skill

SEEN: list[str] = []


class Act(Skill):
    """Fails with the codes of a script, one per start; succeeds when it is used up."""

    codes: tuple[str, ...] = In((), doc="codes still to raise, by start")
    name: str = In("act", doc="which")
    failures = {"SLIPPED": "slipped", "MISSED": "missed", "LOST": "lost"}

    def run(self, robot) -> Run:
        SEEN.append(self.name)
        yield "acting"
        at = SEEN.count(self.name) - 1
        if at < len(self.codes) and self.codes[at] != "OK":
            raise Failure(self.codes[at], f"{self.name} {at + 1}")


class Detect(Skill):
    """Finds on its first start only."""

    found: int = Out(doc="what")
    failures = {"NOTHING": "nothing"}

    def run(self, robot) -> Run:
        SEEN.append("detect")
        yield "looking"
        self.found = SEEN.count("detect")


@pytest.fixture(autouse=True)
def _forget():
    SEEN.clear()


RECOVER = """
trees:
  Main:
    recover:
      attempts: 3
      try:
        - act: {codes: %s, name: a}
      catch:
        SLIPPED: {act: {name: b}}
        MISSED: again
"""


@pytest.mark.parametrize(
    ("codes", "seen", "status"),
    [
        ("[]", "a", "SUCCESS"),
        ("[SLIPPED]", "aba", "SUCCESS"),
        ("[MISSED, SLIPPED]", "aaba", "SUCCESS"),
        ("[SLIPPED, SLIPPED, SLIPPED]", "ababa", "FAILURE"),
        ("[LOST]", "a", "FAILURE"),
        ("[MISSED, LOST]", "aa", "FAILURE"),
    ],
)
def test_recover_answers_codes_and_counts_attempts(run_yaml, codes, seen, status):
    report = run_yaml(RECOVER % codes, Act)
    assert report.status == status
    assert "".join(SEEN) == seen


def test_recover_keeps_the_code_and_adds_the_tries(run_yaml):
    failure = run_yaml(RECOVER % "[SLIPPED, SLIPPED, SLIPPED]", Act).failure
    assert (failure.code, failure.message, failure.node) == ("SLIPPED", "a 3", "act")
    assert (failure.tries, failure.most_tries) == (3, 3)
    assert failure_line(failure) == "SLIPPED, a 3 <- act (tree.yaml:9), 3 of 3 tries"


def test_a_failing_handler_ends_it_with_its_cause_kept(run_yaml):
    text = RECOVER.replace("SLIPPED: {act: {name: b}}", "SLIPPED: {fail: {code: WORSE}}")
    failure = run_yaml(text % "[SLIPPED]", Act).failure
    assert [link.code for link in failure.chain()] == ["WORSE", "SLIPPED"]
    assert failure.tries == 1


CATCHES = """
trees:
  Main:
    %s:
      %s
      try: {act: {codes: [%s], name: a}}
      catch:
        %s: {act: {name: b}}
        any: {act: {name: c}}
"""


@pytest.mark.parametrize(
    ("raised", "named", "seen"),
    [
        ("SLIPPED", "SLIPPED", "aba"),
        ("SLIPPED", "MISSED | SLIPPED", "aba"),
        ("SLIPPED", "MISSED", "aca"),
        ("SLIPPED", "act.SLIPPED", "aba"),
    ],
)
def test_the_handler_that_names_the_code_comes_before_any(run_yaml, raised, named, seen):
    assert run_yaml(CATCHES % ("recover", "attempts: 2", raised, named), Act).status == "SUCCESS"
    assert "".join(SEEN) == seen


def test_handle_gives_the_result_of_its_handler(run_yaml):
    assert run_yaml(CATCHES % ("handle", "", "SLIPPED", "SLIPPED"), Act).status == "SUCCESS"
    assert "".join(SEEN) == "ab"


def test_handle_passes_on_what_nobody_handles(run_yaml):
    text = """
trees:
  Main:
    handle:
      try: {act: {codes: [LOST]}}
      catch:
        SLIPPED: succeed
"""
    assert run_yaml(text, Act).failure.code == "LOST"


def test_handlers_keep_their_place_between_attempts_and_lose_it_with_the_recovery(run_yaml):
    text = """
trees:
  Main:
    repeat:
      cycles: 2
      child:
        recover:
          attempts: 3
          try: {act: {codes: [SLIPPED, SLIPPED, OK, SLIPPED, OK], name: a}}
          catch:
            SLIPPED:
              round_robin:
                - act: {name: x}
                - act: {name: y}
"""
    assert run_yaml(text, Act).status == "SUCCESS"
    assert "".join(SEEN) == "axayaaxa"


def test_what_try_wrote_is_taken_back_before_it_runs_again(run_yaml):
    text = """
values: {n: 1}
trees:
  Main:
    recover:
      attempts: 2
      try:
        - detect: {found: $found}
        - script: $n += $found
        - act: {codes: [SLIPPED], name: a}
      catch:
        SLIPPED:
          - script: $kept := $n
          - script: $n += 10
"""
    board = run_yaml(text, Detect, Act).blackboard
    # handler saw n = 1 + 1; taken back to 1, so the second try gives 1 + 2
    assert board["kept"] == 2
    assert board["n"] == 3


def test_a_handler_reads_the_failure(run_yaml):
    text = """
trees:
  Main:
    handle:
      try: {act: {codes: [SLIPPED], name: a}}
      catch:
        any:
          - set: {key: $code, value: $failure.code}
          - set: {key: $said, value: "${failure.node}: ${failure.message}"}
"""
    board = run_yaml(text, Act).blackboard
    assert board["code"] == "SLIPPED"
    assert board["said"] == "act: a 1"
    assert "failure" not in board


def test_failures_come_out_of_subtrees_with_every_name_on_the_way(run_yaml):
    text = """
trees:
  Main:
    - Put: {what: a}
  Put:
    inputs: {what: text}
    act: {codes: [LOST], name: $what}
    retry: 1
"""
    failure = run_yaml(text, Act).failure
    assert failure_line(failure) == ("LOST, a 1 <- Put (tree.yaml:6) <- act (:9), 1 of 1 tries")


def test_for_each_runs_for_every_item_and_stops_at_a_failure(run_yaml):
    text = """
trees:
  Main:
    for_each: {in: [p, q, r], as: $stop, child: {act: {name: $stop, codes: %s}}}
"""
    assert run_yaml(text % "[]", Act).status == "SUCCESS"
    assert "".join(SEEN) == "pqr"
    SEEN.clear()
    assert run_yaml(text % "[LOST]", Act).failure.message == "p 1"
    assert "".join(SEEN) == "p"


def test_a_timeout_around_a_skill_fails_with_what_was_running_as_its_cause(run_yaml):
    class Forever(Skill):
        """Never ends."""

        def run(self, robot) -> Run:
            while True:
                yield "turning"

    text = """
trees:
  Main:
    - Deep
  Deep:
    forever: {}
    timeout: 1 s
"""
    report = run_yaml(text, Forever)
    links = list(report.failure.chain())
    assert [link.code for link in links] == ["TIMEOUT", "TIMEOUT", "HALTED"]
    assert "turning" in links[-1].message
    assert report.sim_time_s == pytest.approx(1.05)
