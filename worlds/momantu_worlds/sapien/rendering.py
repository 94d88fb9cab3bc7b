"""Making SAPIEN render with our shaders, and a clear word where it cannot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import sapien

from momantu_bt.world import WorldError

SHADERS = Path(__file__).parent / "shaders" / "lambert"


def render_system() -> Any:
    """A render system with our shaders: one pass, Lambert, no shadows.

    Raises:
        WorldError: SAPIEN finds no rendering device.
    """
    sapien.render.set_log_level("error")
    sapien.render.set_camera_shader_dir(str(SHADERS))
    sapien.render.set_picture_format("Color", "r8g8b8a8unorm")
    try:
        return sapien.render.RenderSystem()
    except RuntimeError as error:
        raise WorldError(
            f"SAPIEN cannot render: {error}. It needs a Vulkan driver, in software at least; "
            "`make setup` brings one without touching the system, and `momantu-bt doctor` tells "
            "what is missing"
        ) from None
