"""The private software driver: what was unpacked, and how a process uses it."""

from __future__ import annotations

import ctypes
import json
import os
from dataclasses import dataclass
from pathlib import Path

from momantu_worlds.vulkan.places import driver_folder

MANIFEST = "driver.json"
ICD_VARIABLE = "VK_ICD_FILENAMES"
"""Tells every Vulkan loader, also old ones, which driver description files to read."""

_preloaded: dict[str, ctypes.CDLL] = {}


@dataclass(frozen=True, slots=True)
class PrivateDriver:
    """An unpacked driver: its ICD file and the shared libraries it brings, all absolute paths.

    window_libraries: libX11 and what it needs; SAPIEN's own modules are linked against it.
    driver_libraries: the driver and what it needs.
    packages: `name_version` of every package they came from.
    """

    icd: Path
    window_libraries: tuple[Path, ...]
    driver_libraries: tuple[Path, ...]
    packages: tuple[str, ...]


def installed_driver() -> PrivateDriver | None:
    """The private driver of this user, or None when there is none or it is incomplete."""
    folder = driver_folder()
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        driver = PrivateDriver(
            icd=folder / manifest["icd"],
            window_libraries=tuple(folder / name for name in manifest["window_libraries"]),
            driver_libraries=tuple(folder / name for name in manifest["driver_libraries"]),
            packages=tuple(manifest["packages"]),
        )
    except (OSError, ValueError, KeyError, TypeError):
        return None
    needed = (driver.icd, *driver.window_libraries, *driver.driver_libraries)
    return driver if all(path.is_file() for path in needed) else None


def preload(libraries: tuple[Path, ...]) -> None:
    """Load shared libraries so that later ones find them by name, without LD_LIBRARY_PATH.

    Their order is unknown. Those that cannot be loaded yet are tried again, as long as the last
    round loaded at least one.

    Raises:
        OSError: the remaining libraries cannot be loaded; the message has the loader's own words.
    """
    waiting = [str(path) for path in libraries if str(path) not in _preloaded]
    while waiting:
        failed: list[str] = []
        error: OSError | None = None
        for path in waiting:
            try:
                _preloaded[path] = ctypes.CDLL(path, mode=os.RTLD_NOW | os.RTLD_LOCAL)
            except OSError as reason:
                failed.append(path)
                error = reason
        if error is not None and len(failed) == len(waiting):
            raise error
        waiting = failed


def is_ours(value: str | None) -> bool:
    """True when an ICD variable's value is what an earlier process of ours has put there."""
    return value is not None and value == str(driver_folder() / "icd.json")
