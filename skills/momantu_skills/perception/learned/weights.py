"""Weights in a safetensors file, with a card of where they come from."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import safetensors
import safetensors.torch
import torch

from momantu_bt.formats.files import write_whole
from momantu_skills.perception.learned.header import (
    BROKEN,
    FOREIGN,
    KIND,
    VERSION,
    WeightsError,
    broken,
    categories,
    metadata,
)
from momantu_skills.perception.learned.network import Network

BUNDLED = Path(__file__).parent / "weights.safetensors"
"""The weights that come with the package."""


def save(path: Path, network: Network, card: Mapping[str, Any]) -> None:
    """Write a network's weights in half precision, with its categories."""
    tensors = {
        name: value.detach().to(torch.float16).contiguous()
        for name, value in network.state_dict().items()
    }
    told = {
        "kind": f"{KIND} {VERSION}",
        "categories": json.dumps(network.categories),
        "card": json.dumps(card),
    }
    write_whole(path, safetensors.torch.save(tensors, metadata=told))


def load(path: Path) -> Network:
    """A network with the weights of a file, for use.

    Raises:
        WeightsError: it cannot be read, holds something else, or is of another version.
    """
    network = Network(categories(path))
    try:
        tensors = safetensors.torch.load_file(path, device="cpu")
    except (OSError, safetensors.SafetensorError) as error:
        raise broken(path, error) from None
    own = network.state_dict()
    wrong = [n for n, value in own.items() if n not in tensors or tensors[n].shape != value.shape]
    wrong += [name for name in tensors if name not in own]
    if wrong:
        raise WeightsError(
            FOREIGN,
            f"{path} holds the weights of another network: {wrong[0]!r} does not fit; train them "
            "again with `momantu-bt perception train`",
        )
    if not all(bool(torch.isfinite(value).all()) for value in tensors.values()):
        raise WeightsError(BROKEN, f"{path} holds weights that are not finite; train them again")
    network.load_state_dict({name: value.float() for name, value in tensors.items()})
    return network.eval()


def card(path: Path) -> dict[str, Any]:
    """The card of a file; raises as `load`."""
    found = json.loads(metadata(path).get("card", "{}"))
    return found if isinstance(found, dict) else {}
