"""JSON Schemas of messages that viewers know by their names, as far as a record uses them.

Fields and meanings follow https://docs.foxglove.dev/docs/visualization/message-schemas.
"""

from __future__ import annotations

from momantu_bt.record.mcap.schemas import COUNT, NUMBER, TEXT, Schema, array, record

TIME: Schema = {
    "type": "object",
    "title": "time",
    "properties": {"sec": COUNT, "nsec": {**COUNT, "maximum": 999_999_999}},
    "required": ["sec", "nsec"],
}
DURATION: Schema = {**TIME, "title": "duration"}
BYTES: Schema = {"type": "string", "contentEncoding": "base64"}
VECTOR = record({"x": NUMBER, "y": NUMBER, "z": NUMBER})
QUATERNION = record({"x": NUMBER, "y": NUMBER, "z": NUMBER, "w": NUMBER})
POSE = record({"position": VECTOR, "orientation": QUATERNION})
COLOR = record({"r": NUMBER, "g": NUMBER, "b": NUMBER, "a": NUMBER})
_STAMPED: dict[str, Schema] = {"timestamp": TIME, "frame_id": TEXT}

TRANSFORMS = record(
    {
        "transforms": array(
            record(
                {
                    "timestamp": TIME,
                    "parent_frame_id": TEXT,
                    "child_frame_id": TEXT,
                    "translation": VECTOR,
                    "rotation": QUATERNION,
                }
            )
        )
    }
)
POSE_IN_FRAME = record({**_STAMPED, "pose": POSE})
IMAGE = record({**_STAMPED, "data": BYTES, "format": TEXT})
SCAN = record(
    {
        **_STAMPED,
        "pose": POSE,
        "start_angle": NUMBER,
        "end_angle": NUMBER,
        "ranges": array(NUMBER),
        "intensities": array(NUMBER),
    }
)
GRID = record(
    {
        **_STAMPED,
        "pose": POSE,
        "column_count": COUNT,
        "cell_size": record({"x": NUMBER, "y": NUMBER}),
        "row_stride": COUNT,
        "cell_stride": COUNT,
        "fields": array(record({"name": TEXT, "offset": COUNT, "type": COUNT})),
        "data": BYTES,
    }
)
LOG = record(
    {
        "timestamp": TIME,
        "level": COUNT,
        "message": TEXT,
        "name": TEXT,
        "file": TEXT,
        "line": COUNT,
    }
)
_CUBE = record({"pose": POSE, "size": VECTOR, "color": COLOR})
_CYLINDER = record(
    {"pose": POSE, "size": VECTOR, "bottom_scale": NUMBER, "top_scale": NUMBER, "color": COLOR}
)
_LABEL = record(
    {
        "pose": POSE,
        "billboard": {"type": "boolean"},
        "font_size": NUMBER,
        "scale_invariant": {"type": "boolean"},
        "color": COLOR,
        "text": TEXT,
    }
)
_SPHERE = record({"pose": POSE, "size": VECTOR, "color": COLOR})
_LINE = record(
    {
        "type": COUNT,
        "pose": POSE,
        "thickness": NUMBER,
        "scale_invariant": {"type": "boolean"},
        "points": array(VECTOR),
        "color": COLOR,
        "colors": array(COLOR),
        "indices": array(COUNT),
    }
)
_UNUSED = array({"type": "object"})
SCENE = record(
    {
        "deletions": array(record({"timestamp": TIME, "type": COUNT, "id": TEXT})),
        "entities": array(
            record(
                {
                    **_STAMPED,
                    "id": TEXT,
                    "lifetime": DURATION,
                    "frame_locked": {"type": "boolean"},
                    "metadata": array(record({"key": TEXT, "value": TEXT})),
                    "cubes": array(_CUBE),
                    "cylinders": array(_CYLINDER),
                    "texts": array(_LABEL),
                    "arrows": _UNUSED,
                    "spheres": array(_SPHERE),
                    "lines": array(_LINE),
                    "triangles": _UNUSED,
                    "models": _UNUSED,
                }
            )
        ),
    }
)
