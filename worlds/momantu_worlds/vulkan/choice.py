"""The choice of a driver on this machine: probed once, then remembered."""

from __future__ import annotations

import hashlib
import json
import os
import sys
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from momantu_bt.world import WorldError
from momantu_worlds.vulkan.places import choices_file
from momantu_worlds.vulkan.private import ICD_VARIABLE, installed_driver, is_ours
from momantu_worlds.vulkan.probe import ProbeResult, Way, probe

CURE = "run `momantu-bt doctor --fix` (in a checkout also `make setup`)"
"""What a person does when nothing renders."""

_DRIVER_FOLDERS = (
    "/usr/share/vulkan/icd.d",
    "/usr/local/share/vulkan/icd.d",
    "/etc/vulkan/icd.d",
    "/usr/local/etc/vulkan/icd.d",
)
_VARIABLES = (
    ICD_VARIABLE,
    "VK_DRIVER_FILES",
    "VK_ADD_DRIVER_FILES",
    "LD_LIBRARY_PATH",
    "XDG_DATA_DIRS",
)
_KEPT = 8
"""Most remembered choices, one per virtual environment and machine state; oldest go first."""


@dataclass(frozen=True, slots=True)
class Choice:
    """way: where the driver comes from; device: what renders, in SAPIEN's words."""

    way: Way
    device: str


class VulkanMissingError(WorldError):
    """SAPIEN finds nothing to render with; the message says why and names the cure."""


def machine_state() -> str:
    """A digest of everything a driver's presence depends on; equal state, equal choice."""
    facts: list[object] = [sys.prefix]
    for name in _VARIABLES:
        value = os.environ.get(name)
        facts.append((name, None if is_ours(value) else value))
    for folder in (*_DRIVER_FOLDERS, str(Path.home() / ".local/share/vulkan/icd.d")):
        facts.append((folder, _entries(folder)))
    facts.append([name for name in _names("/dev") if name.startswith("nvidia")])
    facts.append(_names("/dev/dri"))
    facts.append(_modified("/etc/ld.so.cache"))
    driver = installed_driver()
    facts.append(None if driver is None else driver.packages)
    return hashlib.sha256(repr(facts).encode()).hexdigest()


def remembered(state: str) -> Choice | None:
    """The choice made earlier in the same machine state."""
    entry = _read_choices().get(state)
    try:
        return None if entry is None else Choice(Way(entry["way"]), entry["device"])
    except (KeyError, ValueError, TypeError):
        return None


def choose(state: str) -> Choice:
    """Probe the ways, the least intrusive first, and remember the first that renders.

    Raises:
        VulkanMissingError: none renders.
    """
    ways = list(Way) if installed_driver() is not None else [Way.SYSTEM]
    failed: list[tuple[Way, ProbeResult]] = []
    for way in ways:
        result = probe(way)
        if result.renders:
            choice = Choice(way, result.device)
            _remember(state, choice)
            return choice
        failed.append((way, result))
    reasons = "; ".join(f"{way.value}: {result.reason}" for way, result in failed)
    raise VulkanMissingError(
        f"SAPIEN finds no Vulkan device to render with ({reasons}). To mend it, {CURE}"
    )


def _remember(state: str, choice: Choice) -> None:
    """Write the choice down; a cache folder that cannot be written only costs a probe each time."""
    choices = _read_choices()
    choices.pop(state, None)
    choices[state] = {"way": choice.way.value, "device": choice.device}
    file = choices_file()
    fresh = file.with_name(f"{file.name}.{os.getpid()}")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        fresh.write_text(json.dumps(dict(list(choices.items())[-_KEPT:]), indent=1), "utf-8")
        fresh.replace(file)
    except OSError:
        with suppress(OSError):
            fresh.unlink(missing_ok=True)


def _read_choices() -> dict[str, dict[str, str]]:
    try:
        content = json.loads(choices_file().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def _entries(folder: str) -> list[tuple[str, int | None]]:
    return [(name, _modified(f"{folder}/{name}")) for name in _names(folder)]


def _names(folder: str) -> list[str]:
    try:
        return sorted(os.listdir(folder))
    except OSError:
        return []


def _modified(path: str) -> int | None:
    try:
        return Path(path).stat().st_mtime_ns
    except OSError:
        return None
