"""Write the table of AprilTag families that worlds print: codes and places of bits.

Usage: python setup/tag_families.py. It reads the tables of the AprilTag library that pyapriltags
brings along.
"""

from __future__ import annotations

import json
from pathlib import Path

import pyapriltags

from momantu_bt.tags import FAMILIES

TABLE = Path(__file__).parents[1] / "worlds/momantu_worlds/scenes/catalogue/tag_families.json"
MOST = 587
"""Most ids of a family in the table: all of 36h11."""


def family(library: pyapriltags.Detector, name: str) -> dict[str, object]:
    """One family of the library as plain values."""
    found = getattr(library.libc, f"{name}_create")().contents
    bits, most = found.nbits, min(found.ncodes, MOST)
    return {
        "border": found.width_at_border,
        "cells": found.total_width,
        "reversed": bool(found.reversed_border),
        "columns": [found.bit_x[i] for i in range(bits)],
        "rows": [found.bit_y[i] for i in range(bits)],
        "codes": " ".join(f"{found.codes[i]:x}" for i in range(most)),
    }


def main() -> None:
    """Write the table."""
    library = pyapriltags.Detector(families="")
    table = {name: family(library, name) for name in FAMILIES}
    TABLE.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
