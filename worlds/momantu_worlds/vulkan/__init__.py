"""A Vulkan driver for SAPIEN, also on machines without one: call `ensure_vulkan()` first.

Without a GPU SAPIEN needs a software driver of Mesa 24.3 or newer and, even for physics alone,
libX11. Where a machine lacks them, `momantu_worlds.vulkan.install` unpacks both into the user's
cache folder, without root and without touching the system; this module takes them into use.
"""

from __future__ import annotations

from momantu_worlds.vulkan.choice import (
    Choice,
    VulkanMissingError,
    choose,
    machine_state,
    remembered,
)
from momantu_worlds.vulkan.use import apply

__all__ = ["Choice", "VulkanMissingError", "ensure_vulkan"]

_chosen: Choice | None = None


def ensure_vulkan() -> Choice:
    """Prepare this process for `import sapien`; call it before, in every spawned process too.

    The first call on a machine probes in a child process (1-3 s) and remembers the answer; later
    ones take about 15 ms, and nothing at all where the machine's own driver works.

    Raises:
        VulkanMissingError: nothing renders; the message names the cure.
    """
    global _chosen
    if _chosen is None:
        state = machine_state()
        choice = remembered(state) or choose(state)
        apply(choice.way)
        _chosen = choice
    return _chosen
