"""Weights in a safetensors file, with a card of where they come from."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import safetensors
import safetensors.torch
import torch

from momantu_bt.errors import MomantuError
from momantu_bt.formats.files import write_whole
from momantu_skills.perception.learned.network import Network

KIND = "momantu_bt learned detector 1"
"""What the file says it is; its number changes with the network."""
BUNDLED = Path(__file__).parent / "weights.safetensors"
"""The weights that come with the package."""


class WeightsError(MomantuError):
    """A file does not hold weights of this network; the message says why."""


def save(path: Path, network: Network, card: Mapping[str, Any]) -> None:
    """Write a network's weights in half precision."""
    tensors = {
        name: value.detach().to(torch.float16).contiguous()
        for name, value in network.state_dict().items()
    }
    metadata = {"kind": KIND, "card": json.dumps(card)}
    write_whole(path, safetensors.torch.save(tensors, metadata=metadata))


def load(path: Path) -> Network:
    """A network with the weights of a file, for use.

    Raises:
        WeightsError: it cannot be read, or holds something else.
    """
    _metadata(path)
    try:
        tensors = safetensors.torch.load_file(path, device="cpu")
    except (OSError, safetensors.SafetensorError) as error:
        raise _broken(path, error) from None
    network = Network()
    own = network.state_dict()
    wrong = [n for n, value in own.items() if n not in tensors or tensors[n].shape != value.shape]
    wrong += [name for name in tensors if name not in own]
    if wrong:
        raise WeightsError(
            f"{path} holds the weights of another network: {wrong[0]!r} does not fit; train them "
            "again with `momantu-bt perception train`"
        )
    if not all(bool(torch.isfinite(value).all()) for value in tensors.values()):
        raise WeightsError(f"{path} holds weights that are not finite; train them again")
    network.load_state_dict({name: value.float() for name, value in tensors.items()})
    return network.eval()


def card(path: Path) -> dict[str, Any]:
    """The card of a file; raises as `load`."""
    found = json.loads(_metadata(path).get("card", "{}"))
    return found if isinstance(found, dict) else {}


def _metadata(path: Path) -> dict[str, str]:
    try:
        with safetensors.safe_open(path, framework="pt") as file:
            metadata = file.metadata() or {}
    except (OSError, safetensors.SafetensorError) as error:
        raise _broken(path, error) from None
    if metadata.get("kind") != KIND:
        raise WeightsError(
            f"{path} holds no weights of the learned detector: it says {metadata.get('kind')!r}"
            f", expected {KIND!r}; `momantu-bt perception train` makes such"
        )
    return dict(metadata)


def _broken(path: Path, error: Exception) -> WeightsError:
    return WeightsError(
        f"the weights {path} cannot be read: {error}; install the package again, or make them with "
        "`momantu-bt perception train`"
    )
