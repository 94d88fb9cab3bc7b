"""Sites that tell the robot something wrong; the world stays as it is."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from momantu_bt.fault import Fault, FaultError
from momantu_bt.formats.names import valid_names
from momantu_bt.world import Site, seeded

NEAR = 5.0
"""m from the start within which the piece of wall is missing, where there are walls."""
_PGM = re.compile(rb"P5\s+(?:#[^\n]*\n\s*)*(\d+)\s+(\d+)\s+(\d+)\s")


def told(site: Site, fault: Fault, seed: int, folder: Path) -> Site:
    """The site as the fault makes it. folder: where changed maps may be written.

    Raises:
        FaultError: the site has nothing of the kind.
    """
    if fault.name == "table.height":
        return _other_heights(site, fault)
    return _other_map(site, fault, seed, folder)


def _other_heights(site: Site, fault: Fault) -> Site:
    wanted, by = str(fault.parameters["surface"]), float(fault.parameters["by"])
    if wanted and wanted not in site.surfaces:
        hint = valid_names(wanted, site.surfaces, "surfaces")
        raise FaultError(f"{fault.name}: {site.name} has no surface {wanted!r}; {hint}")
    surfaces = {
        name: replace(surface, height=surface.height + by) if wanted in ("", name) else surface
        for name, surface in site.surfaces.items()
    }
    low = [name for name, surface in surfaces.items() if surface.height <= 0.0]
    if low or not surfaces:
        why = f"{low[0]} would lie below the floor" if low else f"{site.name} has no surfaces"
        raise FaultError(f"{fault.name}: {why}")
    return replace(site, surfaces=MappingProxyType(surfaces))


def _other_map(site: Site, fault: Fault, seed: int, folder: Path) -> Site:
    if site.map_file is None:
        raise FaultError(f"{fault.name}: {site.name} has no floor plan")
    random = seeded(seed, fault.name)
    heading = float(random.uniform(-math.pi, math.pi))
    shift, missing = float(fault.parameters["shift"]), float(fault.parameters["missing"])
    way = (shift * math.cos(heading), shift * math.sin(heading))
    plan = _Plan(site.map_file)
    if missing > 0.0:
        plan.erase(site, missing, random)
    changed = replace(site, map_file=plan.write(folder, way))
    if site.overhang_file is not None:
        changed = replace(changed, overhang_file=_Plan(site.overhang_file).write(folder, way))
    return changed


class _Plan:
    """A floor plan in map_server's format, and its picture."""

    def __init__(self, file: Path) -> None:
        from ruamel.yaml import YAML

        try:
            self._entry: dict[str, Any] = YAML(typ="safe", pure=True).load(file.read_text("utf-8"))
            self._picture = (file.parent / str(self._entry["image"])).read_bytes()
            self._resolution = float(self._entry["resolution"])
            self._origin = [float(number) for number in self._entry["origin"]]
        except (OSError, KeyError, TypeError, ValueError) as error:
            raise FaultError(f"map.wrong: the floor plan {file} cannot be read: {error}") from None
        self._name = file.stem

    def erase(self, site: Site, length: float, random: np.random.Generator) -> None:
        """Make a square of the plan free that lies around a piece of wall."""
        pixels, start = self._pixels()
        darkness = 1.0 - pixels / 255.0
        if self._entry.get("negate", 0):
            darkness = 1.0 - darkness
        walls = np.argwhere(darkness > float(self._entry["occupied_thresh"]))
        if not len(walls):
            raise FaultError("map.wrong: there is no wall on the floor plan")
        x = self._origin[0] + (walls[:, 1] + 0.5) * self._resolution
        y = self._origin[1] + (len(pixels) - walls[:, 0] - 0.5) * self._resolution
        near = np.hypot(x - site.start.x, y - site.start.y) < NEAR
        choice = walls[near] if near.any() else walls
        row, column = choice[int(random.integers(len(choice)))]
        half = max(0, round(length / self._resolution / 2.0))
        rows, columns = (slice(max(0, at - half), at + half + 1) for at in (row, column))
        pixels[rows, columns] = 0 if self._entry.get("negate", 0) else 255
        self._picture = self._picture[:start] + pixels.tobytes()

    def write(self, folder: Path, shift: tuple[float, float]) -> Path:
        """Write it to a folder, shifted by m along x and y."""
        (folder / f"{self._name}.pgm").write_bytes(self._picture)
        x, y, yaw = self._origin
        entry = {
            **self._entry,
            "image": f"{self._name}.pgm",
            "origin": [x + shift[0], y + shift[1], yaw],
        }
        lines = [f"{key}: {value}" for key, value in entry.items()]
        file = folder / f"{self._name}.yaml"
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return file

    def _pixels(self) -> tuple[NDArray[np.uint8], int]:
        """The picture (rows, columns), row 0 at the top, and where its pixels begin."""
        head = _PGM.match(self._picture)
        columns, rows, most = (0, 0, 0) if head is None else map(int, head.groups())
        start = 0 if head is None else head.end()
        if most != 255 or len(self._picture) < start + rows * columns:
            raise FaultError(f"map.wrong: {self._name} is no binary PGM picture of 255 grey levels")
        body = np.frombuffer(self._picture, np.uint8, rows * columns, start)
        return body.reshape(rows, columns).copy(), start
