"""How often `check holding` is right, over hand states that are made on purpose.

    python benchmarks/hand_states.py --robot fetch --seeds 0:8 --each 2 -o fit.jsonl
    python benchmarks/hand_states.py --fit fit.jsonl
    python benchmarks/hand_states.py --robot fetch --seeds 100:108 --each 2 --examine -o test.jsonl

Every seed is a world of its own: other things, other errors of the sensors. In it each kind of
state is made `--each` times, and the hand is asked. The truth comes from the physics: something
between the pads that the fingers touch. `--fit` prints what each sense is worth in such states: the
constants of `momantu_skills/manipulation/hand/evidence.py`. With `--examine`, `examine_hand` finds
out where the check cannot tell.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from holding.hand import Hand
from holding.kinds import KINDS
from holding.results import fitted, told
from momantu_skills.check import Check
from momantu_skills.examine_hand import ExamineHand
from momantu_skills.manipulation.hand import between_pads
from momantu_skills.manipulation.hand.weighing import FEELING
from momantu_skills.manipulation.scene.payload import mean_weight
from momantu_skills.perception.camera.snapshot import take

from momantu_bt.failure import Failure


def felt(hand: Hand) -> dict[str, Any]:
    """What the senses measure: fingers, weight, picture."""
    weights = []
    hand.ticks(FEELING, lambda: weights.append(hand.scene.payload.weigh(hand.robot)))
    fingers = hand.scene.holding.fingers
    found: dict[str, Any] = {"width": fingers.width, "effort": fingers.effort}
    known = [w for w in weights if w is not None]
    if known:
        mean = mean_weight(known)
        found |= {"weight": mean.value, "noise": mean.noise, "shared": mean.shared}
        found["aside"] = math.hypot(*mean.aside)
    found["raised"] = hand.scene.payload.raised
    try:
        view = between_pads.between_pads(hand.scene.scene, take(hand.robot, hand.frames))
        found |= dataclasses.asdict(view)
    except Failure as failure:
        found["no_picture"] = failure.value.message
    return found


def examined(hand: Hand) -> dict[str, Any]:
    """What `examine_hand` finds out, and what is true then."""
    result = hand.ask(ExamineHand, hand.frames)
    row: dict[str, Any] = {"examined": result.code or "", "phases": result.phases}
    row["seconds"] = result.duration
    row["truth"] = hand.truth()
    if result.failure is not None:
        return row | {"answer": result.code, "examined_why": result.failure.message}
    row["answer"] = "HOLDING" if result.outputs["holding"] else "NOT_HOLDING"
    row["examined_why"] = result.logs[-1]
    row["again"] = hand.ask(Check, hand.frames, what="holding").code or "HOLDING"
    return row


def states(
    robot: str, seed: int, each: int, kinds: Sequence[str], *, examine: bool, wrist: bool
) -> Iterator[dict[str, Any]]:
    """Make and ask; one row for each check."""
    hand = Hand(robot, seed, wrist=wrist)
    for _ in range(each):
        for kind in KINDS:
            if kinds and kind.__name__ not in kinds:
                continue
            hand.begin()
            kind(hand)
            before = hand.truth()
            row = {"robot": robot, "seed": seed, "kind": kind.__name__, **felt(hand)}
            result = hand.ask(Check, hand.frames, what="holding")
            after = hand.truth()
            row["held"] = hand.weight()
            row["truth"] = after if before is after else None
            row["answer"] = result.code or "HOLDING"
            if result.code == "HOLDING_UNKNOWN" and examine:
                row |= examined(hand)
            row["why"] = "" if result.failure is None else result.failure.message
            row["odds"] = {} if result.failure is None else dict(result.failure.data)
            if any(b.name == "shelf" for b in hand.simulator.added):
                hand.simulator.remove("shelf")
            yield row
    hand.simulator.close()


def _range(text: str) -> range:
    first, _, last = text.partition(":")
    return range(int(first), int(last))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--robot", choices=("fetch", "kinova_jackal"), default="fetch")
    parser.add_argument("--seeds", type=_range, default=range(4))
    parser.add_argument("--each", type=int, default=2)
    parser.add_argument("--kinds", nargs="*", default=())
    parser.add_argument("-o", "--out", type=Path)
    parser.add_argument("--examine", action="store_true", help="find out what is not known")
    parser.add_argument("--no-wrist", action="store_true", help="without the wrist's sensor")
    parser.add_argument("--fit", type=Path, nargs="+", help="files of rows to fit to")
    parser.add_argument("--show", type=Path, nargs="+", help="files of rows to count")
    asked = parser.parse_args(arguments)
    if asked.fit or asked.show:
        texts = [path.read_text(encoding="utf-8") for path in asked.fit or asked.show]
        known = [json.loads(line) for text in texts for line in text.splitlines()]
        print(fitted(known) if asked.fit else told(known))
        return 0
    rows = []
    for seed in asked.seeds:
        made = states(
            asked.robot,
            seed,
            asked.each,
            asked.kinds,
            examine=asked.examine,
            wrist=not asked.no_wrist,
        )
        for row in made:
            rows.append(row)
            if asked.out is not None:
                with asked.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
    print(told(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
