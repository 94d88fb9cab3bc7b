"""Episodes in SAPIEN: physics, drives, sensors and ground truth.

Importing anything in here first looks for a Vulkan driver, which SAPIEN wants before its own
import; a machine without one raises WorldError, so that nothing ever runs half blind.
"""

import warnings

from momantu_bt.world import WorldError
from momantu_worlds.vulkan import VulkanMissingError, ensure_vulkan

try:
    ensure_vulkan()
except VulkanMissingError as error:
    raise WorldError(str(error)) from None

with warnings.catch_warnings():
    # it brings a loader of its own where the system has none, which is not a reason to warn
    warnings.filterwarnings("ignore", message="Failed to find system libvulkan")
    import sapien as _sapien  # noqa: F401
