"""What a weights file says of itself, read without loading what uses it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from momantu_bt.categories import Symmetry, categories_from
from momantu_bt.detector import DetectorError

KIND, VERSION = "momantu_bt learned detector", 3
"""What the file says it is; the number changes with the network and with the metadata."""
LONGEST = 1_000_000
"""Most bytes of a header."""
BROKEN, FOREIGN, OUTDATED = "WEIGHTS_BROKEN", "WEIGHTS_FOREIGN", "WEIGHTS_OUTDATED"
"""Codes: it cannot be read; it holds something else; it is of another version."""
MAKE = "`momantu-bt perception train` makes such a file"


class WeightsError(DetectorError):
    """A file does not hold weights that can be used; the message says why."""


def metadata(path: Path) -> dict[str, str]:
    """The metadata of a weights file, which has all keys that it must have.

    A safetensors file begins with the length of its header (8 bytes, little-endian), which is JSON.

    Raises:
        WeightsError: it cannot be read, holds something else, or is of another version.
    """
    try:
        with path.open("rb") as file:
            length = int.from_bytes(file.read(8), "little")
            header = json.loads(file.read(length)) if length <= LONGEST else None
    except (OSError, ValueError, RecursionError) as error:
        raise broken(path, error) from None
    if not isinstance(header, dict):
        raise broken(path, "it is no safetensors file")
    found: Any = header.get("__metadata__")
    said = found.get("kind") if isinstance(found, dict) else None
    kind, _, version = str(said).rpartition(" ")
    if kind != KIND:
        raise WeightsError(
            FOREIGN,
            f"{path} holds no weights of the learned detector: it says {said!r}, expected "
            f"'{KIND} {VERSION}'; {MAKE}",
        )
    if version != str(VERSION):
        raise WeightsError(
            OUTDATED,
            f"{path} holds weights of version {version}, this detector uses version {VERSION}; "
            "train them again with `momantu-bt perception train`",
        )
    return {str(key): str(value) for key, value in found.items()}


def categories(path: Path) -> dict[str, Symmetry]:
    """The categories that a file's weights tell apart, in their order; raises as `metadata`."""
    try:
        return categories_from(json.loads(metadata(path)["categories"]))
    except (KeyError, ValueError, AttributeError, TypeError) as error:
        raise broken(path, f"its categories are wrong: {error}") from None


def broken(path: Path, error: object) -> WeightsError:
    """The error of a file that cannot be read."""
    return WeightsError(
        BROKEN,
        f"the weights {path} cannot be read: {error}; install the package again, or make them with "
        "`momantu-bt perception train`",
    )
