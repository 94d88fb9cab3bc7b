"""How often a detector gives the asked thing on a table where eight things touch and lie.

    python benchmarks/crowded_table.py --seeds 0:200
    python benchmarks/crowded_table.py --seeds 0:50 --detector both
    python benchmarks/crowded_table.py --seeds 0:200 --absent
    python benchmarks/crowded_table.py --seeds 0:200 --looks 2

Each seed is one picture of the robot's camera, with its errors, of things of the families that are
never trained on. One thing is asked for by its category and sizes, as a tree asks for it; a box has
the sizes that it has as it lies. No other thing of its category has about the same sizes. It is
given if the best match that `detect_object` would accept is within 2 cm of its middle. With
--absent the thing that the next seed would ask for is asked for, unless one like it is there: right
is then to give none. With --looks N there are pictures from N places around the table, and the next
one is taken where a detector gives nothing, as trees look from elsewhere then.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections import Counter
from collections.abc import Sequence

import numpy as np
from momantu_skills.perception.evaluation.measure import SPAN, view_of
from momantu_worlds.labelled.heaps import Manner
from momantu_worlds.labelled.studio import Studio

from momantu_bt.bench.reports.table import columns
from momantu_bt.detector import DETECTORS, ObjectDetector
from momantu_bt.formats.seeds import parse_seeds
from momantu_bt.labelled import Label, Labelled
from momantu_bt.messages import ObjectClass
from momantu_bt.world import seeded

CROWDED = Manner(upright=0.45, touching=0.85, tray=0.0, clutter=0.0, arm=0.0, things=(8, 9))
"""Eight things, most of them put against another one; most round ones lie."""
NEAR = 0.02
"""Distance from the thing's middle up to which it is given, m."""
LEAST = 600
"""Pixels that show the asked thing: a robot would look from elsewhere for one that is hidden."""
APART = 0.3
"""Relative difference in one size by which the asked thing differs from others of its category."""
STANDS = 0.9
"""Cosine of the tilt up to which a thing stands."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Ask each detector for one thing in each picture, and print how often it was given."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--seeds", default="0:100")
    parser.add_argument("--detector", action="append", choices=sorted(DETECTORS))
    parser.add_argument("--absent", action="store_true", help="ask for what is not there")
    parser.add_argument("--looks", type=int, default=1, help="from so many places")
    told = parser.parse_args(arguments)
    names = told.detector or ["learned", "geometric"]
    studio = Studio((), testing=True, manner=CROWDED)
    counts: dict[str, Counter[tuple[str, str]]] = {name: Counter() for name in names}
    times: dict[str, list[float]] = {name: [] for name in names}
    for seed in parse_seeds(told.seeds):
        looks = studio.pictures(seed, told.looks)
        made = looks[0]
        shown = studio.picture(seed + 1) if told.absent else made
        thing = asked(shown)
        if thing is None or (told.absent and any(_alike(thing, other) for other in made.things)):
            continue
        for name in names:
            start = time.process_time()
            found = given(looks, shown, thing, DETECTORS.load(name)())
            times[name].append(time.process_time() - start)
            counts[name][found, "all"] += 1
            counts[name][found, thing.category] += 1
            counts[name][found, "lies" if _lies(shown, thing) else "stands"] += 1
    kinds = ("all", "stands", "lies", *sorted({thing for c in counts.values() for _, thing in c}))
    rows = [("detector", "asked", "times", "given", "another", "none", "ms")]
    for name in names:
        middle = f"{1000 * statistics.median(times[name]):.0f}" if times[name] else "-"
        for kind in dict.fromkeys(kinds):
            number = {way: counts[name][way, kind] for way in ("given", "another", "none")}
            total = sum(number.values())
            if total:
                shares = (f"{100 * count / total:.1f} %" for count in number.values())
                rows.append((name, kind, str(total), *shares, middle))
    print("\n".join(columns(rows)))
    return 0


def asked(made: Labelled) -> Label | None:
    """The thing that is asked for; None if each is hidden or has a twin."""
    candidates = [
        thing
        for thing in made.things
        if thing.seen >= LEAST
        and not any(_alike(thing, other) for other in made.things if other is not thing)
    ]
    if not candidates:
        return None
    return candidates[int(seeded(made.seed, "asked").integers(len(candidates)))]


def given(
    looks: Sequence[Labelled], shown: Labelled, thing: Label, detector: ObjectDetector
) -> str:
    """What a detector gives for a thing of picture `shown`: "given", "another" or "none"."""
    for look in looks:
        low, high = look.height - SPAN, look.height + SPAN
        found = detector.detect([view_of(look)], low, high, as_asked(shown, thing)) or ()
        best = next((one for one in found if one.score >= detector.accepted), None)
        if best is not None:
            true = (shown.odom_from_camera @ thing.camera_from_object).position
            near = float(np.linalg.norm(best.pose.position - true)) < NEAR
            return "given" if shown is looks[0] and near else "another"
    return "none"


def as_asked(made: Labelled, thing: Label) -> ObjectClass:
    """What a tree would ask for to get a thing."""
    wide, _, long = thing.size
    if thing.category != "box":
        return ObjectClass(thing.category, diameter=wide, height=long)
    upright = np.abs((made.odom_from_camera @ thing.camera_from_object).rotation[2])
    order = [int(upright.argmax())]
    order += [axis for axis in range(3) if axis not in order]
    height, width, depth = (thing.size[axis] for axis in order)
    return ObjectClass("box", height=height, width=width, depth=depth)


def _lies(made: Labelled, thing: Label) -> bool:
    """Whether a round thing does not stand; a box always stands on a side."""
    axis = (made.odom_from_camera @ thing.camera_from_object).rotation[2, 2]
    return thing.category != "box" and abs(float(axis)) < STANDS


def _alike(one: Label, other: Label) -> bool:
    """Whether one could be taken for the other by category and sizes."""
    if one.category != other.category:
        return False
    return bool(np.allclose(sorted(one.size), sorted(other.size), rtol=APART, atol=0.0))


if __name__ == "__main__":
    raise SystemExit(main())
