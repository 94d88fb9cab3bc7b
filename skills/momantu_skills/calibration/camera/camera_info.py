"""A lens as ROS writes it: the YAML of camera_info, and its names of models."""

from __future__ import annotations

from typing import Any

import numpy as np

from momantu_skills.calibration.camera.lens import ROS_MODEL, Lens


def camera_info(lens: Lens, size: tuple[int, int], name: str) -> str:
    """The text of a file that camera_info_manager of ROS reads."""
    projection = np.hstack([lens.matrix, np.zeros((3, 1))])
    return "\n".join(
        [
            f"image_width: {size[0]}",
            f"image_height: {size[1]}",
            f"camera_name: {name}",
            *_matrix("camera_matrix", lens.matrix),
            f"distortion_model: {ROS_MODEL[lens.model]}",
            *_matrix("distortion_coefficients", lens.distortion.reshape(1, -1)),
            *_matrix("rectification_matrix", np.eye(3)),
            *_matrix("projection_matrix", projection),
            "",
        ]
    )


def _matrix(name: str, values: Any) -> list[str]:
    data = ", ".join(f"{value:.9g}" for value in values.ravel())
    return [
        f"{name}:",
        f"  rows: {values.shape[0]}",
        f"  cols: {values.shape[1]}",
        f"  data: [{data}]",
    ]
