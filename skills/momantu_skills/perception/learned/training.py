"""Train the network on labelled pictures; an interrupted training goes on from its state."""

from __future__ import annotations

import math
import pickle
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from momantu_bt.errors import MomantuError
from momantu_bt.geometry import Array
from momantu_bt.labelled import categories_in, seeds_in
from momantu_bt.world import seeded
from momantu_skills.perception.learned import examples, weights
from momantu_skills.perception.learned.losses import COORDINATE_WEIGHT, OFFSET_WEIGHT, loss
from momantu_skills.perception.learned.network import Network
from momantu_skills.perception.learned.targets import Targets

WARM = 0.05
"""Share of the steps in which the learning rate rises."""
CLIP = 1.0
"""Largest norm of a step's gradient."""
KEEP = 120.0
"""Time between two saved states, s of wall time; it decides nothing but where a stop goes on."""
DECAY = 0.01
"""Weight decay."""

Seen = NDArray[np.float32]


class TrainingError(MomantuError):
    """A training cannot begin or go on; the message says why."""


@dataclass(frozen=True, slots=True)
class Plan:
    """All that a training depends on besides its pictures."""

    epochs: int = 4
    batch: int = 8
    rate: float = 2e-3
    seed: int = 0


@dataclass(slots=True)
class Training:
    """A training as far as it is. step: batches so far, of `steps`. device: "cpu" or "cuda".

    stop: batches after which it ends before the plan does.
    """

    folder: Path
    plan: Plan
    seeds: tuple[int, ...]
    network: Network
    optimizer: torch.optim.Optimizer
    device: str
    step: int = 0
    stop: int | None = None

    @property
    def steps(self) -> int:
        """Batches of the whole plan."""
        return self.plan.epochs * math.ceil(len(self.seeds) / self.plan.batch)

    @property
    def last(self) -> int:
        """Batches after which it ends."""
        return self.steps if self.stop is None else min(self.stop, self.steps)


def begin(folder: Path, plan: Plan, device: str, start: Path | None = None) -> Training:
    """A training that has not begun. start: weights to start from instead of random ones.

    Raises:
        TrainingError: the folder holds no labelled pictures.
        WeightsError: `start` is none.
    """
    seeds = seeds_in(folder) if folder.is_dir() else ()
    if not seeds:
        raise TrainingError(
            f"{folder} holds no labelled pictures; make some with `momantu-bt perception render -o "
            f"{folder}`"
        )
    torch.manual_seed(plan.seed)
    categories = categories_in(folder)
    network = Network(categories) if start is None else weights.load(start).knowing(categories)
    network = network.to(device).train()
    optimizer = torch.optim.AdamW(network.parameters(), lr=plan.rate, weight_decay=DECAY)
    return Training(folder, plan, seeds, network, optimizer, device)


def resume(training: Training, state: Path) -> None:
    """Go on where a saved state of the same training ended.

    Raises:
        TrainingError: the state is damaged, or belongs to another training.
    """
    try:
        saved: dict[str, Any] = torch.load(state, map_location=training.device, weights_only=True)
        same = saved["plan"] == asdict(training.plan) and saved["pictures"] == len(training.seeds)
        if same:
            training.network.load_state_dict(saved["network"])
            training.optimizer.load_state_dict(saved["optimizer"])
            training.step = int(saved["step"])
    except (OSError, KeyError, ValueError, RuntimeError, EOFError, pickle.UnpicklingError) as error:
        raise TrainingError(
            f"the state {state} cannot be read: {str(error).splitlines()[0]}; remove it"
        ) from None
    if not same:
        raise TrainingError(
            f"the state {state} belongs to a training with {saved['pictures']} pictures and "
            f"{saved['plan']}; give the same, or remove it to begin anew"
        )


def keep(training: Training, state: Path) -> None:
    """Save the state from which `resume` goes on."""
    saved = {
        "plan": asdict(training.plan),
        "pictures": len(training.seeds),
        "step": training.step,
        "network": training.network.state_dict(),
        "optimizer": training.optimizer.state_dict(),
    }
    beside = state.with_name(f"{state.name}.new")
    torch.save(saved, beside)
    beside.replace(state)


def go_on(training: Training, state: Path, tell: Callable[[str], None]) -> None:
    """Train to the end, saving the state now and then and at Ctrl-C."""
    start, first, saved = time.monotonic(), training.step, time.monotonic()
    sums = np.zeros(3)
    try:
        for made in _batches(training):
            sums = 0.98 * sums + 0.02 * np.array(_step(training, made))
            if training.step % 50 == 0:
                share = (training.step - first) / (time.monotonic() - start)
                left = (training.last - training.step) / share / 60
                weight = 1.0 - 0.98 ** (training.step - first)
                told = " ".join(f"{value:.4f}" for value in sums / weight)
                tell(f"batch {training.step} of {training.steps}: loss {told}, {left:.0f} min left")
            if time.monotonic() - saved > KEEP:
                keep(training, state)
                saved = time.monotonic()
    finally:
        keep(training, state)


def _batches(training: Training) -> Iterator[Sequence[tuple[Seen, Targets]]]:
    """The batches that are left, in the order of the training's seed."""
    plan = training.plan
    per_epoch = math.ceil(len(training.seeds) / plan.batch)
    while training.step < training.last:
        epoch, done = divmod(training.step, per_epoch)
        order = seeded(plan.seed, "order", epoch).permutation(np.array(training.seeds)).tolist()
        end = min(len(order), done * plan.batch + (training.last - training.step) * plan.batch)
        for first in range(done * plan.batch, end, plan.batch):
            made = (_drawn(training, seed, epoch) for seed in order[first : first + plan.batch])
            yield [each for each in made if each is not None]


def _drawn(training: Training, seed: int, epoch: int) -> tuple[Seen, Targets] | None:
    """An example as it is seen in an epoch: mirrored, or in other colours."""
    found = examples.kept(training.folder, seed)
    if found is None:
        return None
    draw = seeded(training.plan.seed, "example", epoch, seed)
    seen, made = found.arrays(training.network.classes)
    if draw.random() < 0.5:
        seen, made = examples.mirrored(seen, made)
    return examples.recolored(seen, draw), made


def _step(training: Training, made: Sequence[tuple[Seen, Targets]]) -> tuple[float, float, float]:
    """Learn from a batch; its losses."""
    training.step += 1
    if not made:
        return 0.0, 0.0, 0.0
    for group in training.optimizer.param_groups:
        group["lr"] = training.plan.rate * _share(training.step / training.steps)
    training.optimizer.zero_grad(set_to_none=True)
    sums = np.zeros(3)
    for each in made:
        sums += _learned(training, each, 1.0 / len(made))
    torch.nn.utils.clip_grad_norm_(training.network.parameters(), CLIP)
    training.optimizer.step()
    classes, places, votes = sums.tolist()
    return classes, places, votes


def _learned(training: Training, made: tuple[Seen, Targets], share: float) -> Array:
    """Add a picture's share of a batch's gradient; its share of the losses (3,).

    Each picture is by itself, as when the detector looks: what a crop is padded with would change
    the mean over which the network normalises.
    """
    seen, *truth = (torch.from_numpy(a).to(training.device) for a in examples.alone(*made))
    seen = seen.contiguous(memory_format=torch.channels_last)
    # half precision gains nothing on a processor: normalising is slow there
    faster = training.device == "cuda"
    with torch.autocast(training.device, dtype=torch.bfloat16, enabled=faster):
        scores, coordinates, offsets = training.network(seen)
    classes, places, votes = loss(
        scores.float(), coordinates.float(), offsets.float(), tuple(truth)
    )
    whole = classes + COORDINATE_WEIGHT * places + OFFSET_WEIGHT * votes
    torch.autograd.backward(share * whole)
    return share * np.array([classes.item(), places.item(), votes.item()])


def _share(done: float) -> float:
    """The learning rate as a share of the highest: a short rise, then half a cosine."""
    if done < WARM:
        return done / WARM
    return 0.5 * (1.0 + math.cos(math.pi * (done - WARM) / (1.0 - WARM)))
