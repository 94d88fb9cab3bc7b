"""`momantu-bt robots schema`: a JSON Schema of robot files, for editors."""

from __future__ import annotations

from typing import Any

from momantu_bt.cli.shared.schema_file import Out, put_schema
from momantu_bt.descriptions.schema import editor_schema
from momantu_bt.errors import ExitCode
from momantu_bt.robots.robot_file import RobotFile


def robot_schema() -> dict[str, Any]:
    """The schema, from the models that read robot files."""
    made = RobotFile.model_json_schema(mode="validation")
    return editor_schema(made, "momantu-bt robot file")


def schema(out: Out = None) -> ExitCode:
    """Print a JSON Schema of robot files.

    With it editors complete keys, show what they mean, and mark what is wrong while it is typed;
    reading the file says more.

    Examples:
      momantu-bt robots schema -o robot.schema.json
    """
    return put_schema(robot_schema(), out, "a robot file")
