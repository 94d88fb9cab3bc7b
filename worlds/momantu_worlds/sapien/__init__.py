"""Episodes in SAPIEN: physics, drives, sensors and ground truth.

Importing anything in here first looks for a Vulkan driver, which SAPIEN wants before its own
import; a machine without one raises WorldError, so that nothing ever runs half blind.
"""

from momantu_bt.vulkan import VulkanMissingError, ensure_vulkan
from momantu_bt.world import WorldError

try:
    ensure_vulkan()
except VulkanMissingError as error:
    raise WorldError(str(error)) from None
