"""How exactly `calibrate hand-eye` tells a camera's mounting, beside what is possible at all.

    python benchmarks/hand_eye.py --problems 100

Random robots, mountings and boards: 17 views of a board 0.4 to 0.9 m away, turned by 0.5 rad about
each axis, with noise of 0.3 degrees and 1 mm along each axis. The noise is of the target's pose, of
the hand's, or of both; some views are wrong in one of several ways. The bound is that of Cramér and
Rao with the right views and the true noise: no unbiased method has smaller errors, in the mean.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from momantu_skills.calibration.hand_eye.closed_form import METHODS, closed_form
from momantu_skills.calibration.hand_eye.estimate import JOINT, solve
from momantu_skills.calibration.hand_eye.linear import linearised
from momantu_skills.calibration.hand_eye.noise import inverses, shapes
from momantu_skills.calibration.hand_eye.views import Mounting, Views
from momantu_skills.calibration.poses import Indices, Poses, angles, rotations_of

from momantu_bt.geometry import Array, Transform

TURN, SHIFT = np.radians(0.3), 0.001
"""Noise along each axis, rad and m."""
SPREAD = 0.52
"""rad about each axis by which the views are turned."""
TARGET, CAMERA, HAND, BOTH = "target's pose", "the same, about the camera", "hand's pose", "both"
SHARE = 0.24
"""Of the views, those that are wrong: 4 of 17."""
VARIANCES = {  # of shapes(): a shift, and turns about target, camera, hand and base
    TARGET: (SHIFT**2, TURN**2, 0.0, 0.0, 0.0),
    CAMERA: (SHIFT**2, 0.0, TURN**2, 0.0, 0.0),
    HAND: (SHIFT**2, 0.0, 0.0, TURN**2, 0.0),
    BOTH: (2 * SHIFT**2, TURN**2, 0.0, TURN**2, 0.0),
}
WRONG = ("anywhere", "off by 25 deg and 15 cm", "mirrored board", "another tag", "stale", "flipped")
"""How views are wrong: mirrored and another tag agree with each other; stale ones are those of the
view before; flipped is the other solution for the pose of a flat board."""


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Views, the truth, the views as they were without noise, and which are wrong."""

    views: Views
    true: Mounting
    exact: Views
    wrong: Indices


def problem(
    seed: int, noise: str, wrong: str = "", share: float = SHARE, count: int = 17
) -> Problem:
    """A random robot, mounting and board; a share of its views is wrong."""
    rng = np.random.default_rng(seed)
    eye = Transform(rng.uniform(-0.15, 0.15, 3), rng.normal(size=4))
    target = Transform(rng.uniform(-1.0, 1.0, 3), rng.normal(size=4))
    place = np.column_stack([rng.uniform(-0.15, 0.15, (count, 2)), rng.uniform(0.4, 0.9, count)])
    seen = Poses(rotations_of(rng.normal(0, SPREAD, (count, 3))), place)
    hand = Poses.of([target]) @ seen.inverse() @ Poses.of([eye.inverse()])
    exact = Views(hand, seen)
    ours, theirs = (_small(rng, count, TURN, SHIFT) for _ in range(2))
    if noise in (TARGET, BOTH):
        seen = seen @ ours
    if noise == CAMERA:
        seen = ours @ seen
    if noise in (HAND, BOTH):
        hand = hand @ theirs
    chosen = np.sort(rng.permutation(count)[: round(share * count) if wrong else 0])
    bad = _spoiled(seen, chosen, wrong, rng)
    seen.rotations[chosen], seen.positions[chosen] = bad.rotations, bad.positions
    return Problem(Views(hand, seen), Mounting(eye, target), exact, chosen)


def _small(rng: np.random.Generator, count: int, turn: float, shift: float) -> Poses:
    turns = rotations_of(rng.normal(0, turn, (count, 3)))
    return Poses(turns, rng.normal(0, shift, (count, 3)))


def _spoiled(seen: Poses, chosen: Indices, wrong: str, rng: np.random.Generator) -> Poses:
    """The chosen views as a mistake leaves them."""
    good, count = seen[chosen], len(chosen)
    if wrong == "anywhere":
        turns = rotations_of(rng.normal(0, 1.2, (count, 3)))
        return Poses(turns, rng.uniform(-0.3, 0.9, (count, 3)))
    if wrong == "off by 25 deg and 15 cm":
        return good @ _small(rng, count, np.radians(25.0), 0.15)
    if wrong == "mirrored board":  # counted from the other corner: half a turn about the normal
        return good @ Poses.of([Transform((0.16, 0.1, 0.0), (0.0, 0.0, 0.0, 1.0))])
    if wrong == "another tag":
        return good @ Poses.of([Transform(rng.uniform(-0.3, 0.3, 3), rng.normal(size=4))])
    if wrong == "stale":
        return seen[(chosen - 1) % len(seen)]
    if wrong == "flipped":
        line = good.positions / np.linalg.norm(good.positions, axis=1, keepdims=True)
        about = 2.0 * line[:, :, None] * line[:, None, :] - np.eye(3)
        return Poses(about @ good.rotations @ np.diag([-1.0, -1.0, 1.0]), good.positions)
    return good


def bound(given: Problem, noise: str, rng: np.random.Generator, draws: int = 50) -> Array:
    """Errors (draws, 2), deg and mm, as large as those of the best unbiased estimate."""
    right = given.exact[np.setdiff1d(np.arange(len(given.exact)), given.wrong)]
    rows = linearised(right, given.true).rows
    inverse = inverses(np.array(VARIANCES[noise]), shapes(right, given.true))
    square = (np.swapaxes(rows, -1, -2) @ inverse @ rows).sum(axis=0)
    drawn = rng.multivariate_normal(np.zeros(12), np.linalg.inv(square), draws)
    lengths = np.linalg.norm(drawn[:, :6].reshape(-1, 2, 3), axis=2)
    return np.asarray(lengths * [np.degrees(1.0), 1e3])


def errors(found: Transform, true: Transform) -> tuple[float, float]:
    """The angle in deg and the distance in mm between two transforms."""
    apart = float(np.linalg.norm(found.position - true.position))
    return float(np.degrees(angles(found.rotation.T @ true.rotation))), 1e3 * apart


def measure(noise: str, wrong: str, problems: int, share: float) -> str:
    """A row of the table: medians of the bound, the joint refinement and the closed forms."""
    rng, least = np.random.default_rng(0), []
    off: dict[str, list[tuple[float, float]]] = {name: [] for name in (JOINT, *METHODS)}
    missed = extra = 0
    for seed in range(problems):
        given = problem(seed, noise, wrong, share)
        least.append(bound(given, noise, rng))
        found = solve(given.views, seed)
        off[JOINT].append(errors(found.mounting.eye, given.true.eye))
        told = np.flatnonzero(found.outliers)
        missed += len(np.setdiff1d(given.wrong, told))
        extra += len(np.setdiff1d(told, given.wrong))
        for name in METHODS:
            simple = closed_form(given.views, name)
            if simple is not None:
                off[name].append(errors(simple.eye, given.true.eye))
    best = np.median(np.concatenate(least), axis=0)
    middle = {name: np.median(each, axis=0) for name, each in off.items()}
    far = np.percentile(off[JOINT], 90, axis=0)
    closed = min((middle[name][1], name) for name in METHODS)
    return (
        f"| {noise} | {wrong or 'none'} | {best[0]:.2f} | {middle[JOINT][0]:.2f} | {best[1]:.2f} | "
        f"{middle[JOINT][1]:.2f} | {far[1]:.2f} | {closed[0]:.1f} ({closed[1]}) | {missed} | "
        f"{extra} |"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--problems", type=int, default=100, help="random robots for each row")
    parser.add_argument("--share", type=float, default=SHARE, help="of the views that are wrong")
    given = parser.parse_args(arguments)
    print("| noise of | wrong | bound, deg | joint | bound, mm | joint | 90 % below | ", end="")
    print("best closed form, mm | missed | right ones left out |\n" + "|---" * 10 + "|")
    rows = [(noise, "") for noise in VARIANCES] + [(TARGET, wrong) for wrong in WRONG]
    for noise, wrong in [*rows, (HAND, WRONG[1]), (BOTH, WRONG[1])]:
        print(measure(noise, wrong, given.problems, given.share), flush=True)


if __name__ == "__main__":
    main()
