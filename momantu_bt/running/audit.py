"""The audit: compares what skills claim when they end with the true state of the world."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from momantu_bt.claim import Claim, Judge, Sentence
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.outside import SkillEnded, SkillNode, SkillSession
from momantu_bt.engine.skills.session import Session
from momantu_bt.errors import PLUGIN_ERRORS, words_of
from momantu_bt.geometry import Transform
from momantu_bt.record.report import FalseClaim, SkillClaims
from momantu_bt.world import World


class Auditor:
    """When a skill ends, asks it what it claims, and asks the world whether that is true.

    It subscribes to `SkillEnded`. The run does not depend on it: an error here is only a remark,
    and the claim is not counted. In a world without a `Judge`, nothing is judged.
    """

    def __init__(self, context: RunContext, world: World | None) -> None:
        self._context = context
        self._judge = world if isinstance(world, Judge) else None
        self._claims: dict[str, SkillClaims] = {}
        context.events.subscribe(SkillEnded, self._ended)

    def claims(self) -> Mapping[str, SkillClaims]:
        """The counts so far, by the skill's name in the tree, in the order in which they ended."""
        return dict(self._claims)

    def _ended(self, event: SkillEnded) -> None:
        leaf, session = event
        name, failure = leaf.skill_name, session.failure
        count = self._claims.get(name, SkillClaims())
        claim, truth = self._judged(leaf, session)
        false = truth is (failure is not None)
        if failure is None:
            count = replace(
                count,
                successes=count.successes + 1,
                judged_successes=count.judged_successes + (truth is not None),
                false_successes=count.false_successes + false,
            )
        else:
            count = replace(
                count,
                failures=count.failures + 1,
                judged_failures=count.judged_failures + (truth is not None),
                false_failures=count.false_failures + false,
            )
        if false:
            code = None if failure is None else failure.code
            lie = FalseClaim(self._context.now, leaf.place, code, str(claim))
            count = replace(count, lies=(*count.lies, lie))
        self._claims[name] = replace(count, runs=count.runs + 1)

    def _judged(self, leaf: SkillNode, session: SkillSession) -> tuple[Claim | None, bool | None]:
        """The skill's claim, and whether it is true; None if it cannot be judged."""
        skill = session.skill if isinstance(session, Session) else None
        body = self._context.body
        if self._judge is None or skill is None or body is None:
            return None, None
        # A lease without actuators: making a claim must not move the robot.
        robot = body.actuators.lease(f"the claim of {leaf.name}", ())
        try:
            claim = skill.claim(robot, session.failure)
            if claim is None:
                return None, None
            sentences = claim if isinstance(claim, tuple) else (claim,)
            return claim, self._all(sentences, robot.state().odom_from_base)
        except PLUGIN_ERRORS as error:
            what = f"{words_of(error)}"
            self._context.remark(f"{leaf.where}: its claim cannot be judged: {what}")
            return None, None

    def _all(self, sentences: tuple[Sentence, ...], odom_from_base: Transform) -> bool | None:
        """Whether all are true: False if one is false, otherwise None if one cannot be judged."""
        assert self._judge is not None
        answers = [self._judge.judge(sentence, odom_from_base) for sentence in sentences]
        if False in answers:
            return False
        return None if None in answers or not answers else True
