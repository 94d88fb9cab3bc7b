"""Folders of the private driver and of what is known about drivers."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.formats.cache import cache_folder


def driver_folder() -> Path:
    """The folder of the private driver; it need not exist."""
    return cache_folder() / "vulkan"


def choices_file() -> Path:
    """Remembers per machine state which driver worked, so that nothing is probed twice."""
    return cache_folder() / "vulkan-choices.json"
