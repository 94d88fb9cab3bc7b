"""`momantu-bt perception train`: train the learned detector's network."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import check_writable
from momantu_bt.lazy import lazily

with lazily():
    import torch

    from momantu_skills.perception.learned import training as trainings
    from momantu_skills.perception.learned import weights


def train(
    pictures: Annotated[Path, typer.Argument(help="The folder that `perception render` filled.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The weights: a .safetensors file.")],
    epochs: Annotated[int, typer.Option(min=1, help="How often each picture is seen.")] = 4,
    batch: Annotated[int, typer.Option(min=1, max=256, help="Pictures learned at once.")] = 8,
    rate: Annotated[float, typer.Option(min=1e-6, max=1.0, help="Highest learning rate.")] = 2e-3,
    seed: Annotated[int, typer.Option(min=0, help="Of weights, order and changes.")] = 0,
    start: Annotated[
        Path | None, typer.Option(help="Weights to start from instead of random ones.")
    ] = None,
    stop: Annotated[
        int | None, typer.Option(min=1, help="End after so many batches, before the epochs do.")
    ] = None,
    device: Annotated[str, typer.Option(help="What trains: cpu, or cuda for a GPU.")] = "cpu",
) -> ExitCode:
    """Train the network of the detector `learned` on labelled pictures.

    Its state is kept beside the weights, as OUT.state: the same command goes on where an
    interrupted one ended.

    Exit code 0: the weights are written; 2: the arguments or files are wrong.

    Examples:
      momantu-bt perception train pictures -o my_weights.safetensors --epochs 4
      momantu-bt perception train more -o better.safetensors --start my_weights.safetensors
    """
    check_writable(out, regular=True)
    if device not in ("cpu", "cuda"):
        raise InputError(f"--device {device!r}; expected cpu or cuda")
    if device == "cuda" and not torch.cuda.is_available():
        raise InputError("--device cuda: no GPU can be used here; leave the option out")
    torch.set_num_threads(1)
    plan = trainings.Plan(epochs, batch, rate, seed)
    training = trainings.begin(pictures, plan, device, start)
    training.stop = stop
    state = out.with_name(f"{out.name}.state")
    if state.exists():
        trainings.resume(training, state)
        typer.echo(f"going on at batch {training.step} of {training.steps}", err=True)
    trainings.go_on(training, state, lambda line: typer.echo(line, err=True))
    early = "" if stop is None else f" --stop {stop}"
    origin = "" if start is None else f" --start {start.name}"
    told = f"{origin} --epochs {epochs} --batch {batch} --rate {rate} --seed {seed}{early}"
    card = {
        "command": f"momantu-bt perception train {pictures.name} -o {out.name}{told}",
        "pictures": len(training.seeds),
        "seeds": [training.seeds[0], training.seeds[-1]],
        **asdict(plan),
        "started_from": "random weights" if start is None else start.name,
    }
    weights.save(out, training.network, card)
    typer.echo(f"{out}: {out.stat().st_size / 1e6:.1f} MB after {training.step} batches")
    return ExitCode.SUCCESS
