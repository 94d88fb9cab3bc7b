"""Objects as the robot believes them: `/objects`."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from momantu_bt.engine.executor import Executor
from momantu_bt.geometry import Transform
from momantu_bt.messages import DetectedObject
from momantu_bt.record.channels.channel import Due, stamp_of, time_text
from momantu_bt.record.channels.poses import pose_text
from momantu_bt.record.codec import dumps
from momantu_bt.record.mcap.file import McapFile
from momantu_bt.record.mcap.viewer_schemas import SCENE
from momantu_bt.service import HeldObject, KnowsHeld, offers

HELD = "held"
"""Identifier of the held object; the others have the name of their cell of the board."""
RATE = 5.0
"""Rate at which services are asked for the held object, Hz."""
_SEEN = '{"r":0.2,"g":0.6,"b":0.9,"a":0.7}'
_IN_HAND = '{"r":0.9,"g":0.6,"b":0.1,"a":0.9}'
_UNUSED = (
    '"lifetime":{"sec":0,"nsec":0},"arrows":[],"spheres":[],"lines":[],"triangles":[],"models":[]'
)


class Objects:
    """Writes an entity for each detected object on the board, and for the one that is held."""

    def __init__(self, file: McapFile) -> None:
        self._channel = file.channel("/objects", "foxglove.SceneUpdate", SCENE)
        self._due = Due(RATE)
        self._shown: dict[str, list[str]] = {}
        self._held: HeldObject | None = None

    def write(self, run: Executor, file: McapFile) -> None:
        """Write the objects that appeared or disappeared since the last tick."""
        due = self._due(run.context.now)
        if not due and not run.context.writes:
            return
        time = time_text(run.context.now)
        cells = {cell.name: cell.value for cell, _ in run.context.writes}
        entities, gone = [], []
        for name, value in cells.items():
            objects = objects_in(value)
            if objects or name in self._shown:
                before = self._shown.get(name, [])
                names = [name if len(objects) == 1 else f"{name}[{i}]" for i in range(len(objects))]
                gone += [old for old in before if old not in names]
                entities += [_seen(*each, time) for each in zip(names, objects, strict=True)]
                self._shown[name] = names
        if due:
            held = _believed(run)
            if held is not self._held:
                entities += [] if held is None else [_in_hand(run, held, time)]
                gone += [HELD] if held is None else []
                self._held = held
        if entities or gone:
            deletions = [f'{{"timestamp":{time},"type":0,"id":{dumps(name)}}}' for name in gone]
            text = f'{{"deletions":[{",".join(deletions)}],"entities":[{",".join(entities)}]}}'
            file.add(self._channel, stamp_of(run.context.now), text)


def _believed(run: Executor) -> HeldObject | None:
    """The held object as the first service that publishes it believes, if it can be drawn."""
    knowing = (each for each in run.services.running.values() if offers(each, KnowsHeld))
    held = getattr(next(knowing, None), "held", None)
    return held if isinstance(held, HeldObject) and _drawable(held.object) else None


def objects_in(value: Any) -> list[DetectedObject]:
    """The objects in a value that viewers can draw; they cannot draw NaN."""
    things = value if type(value) is tuple else (value,)
    return [thing for thing in things if type(thing) is DetectedObject and _drawable(thing)]


def _drawable(thing: DetectedObject) -> bool:
    return math.isfinite(sum(thing.size) + float(thing.pose.position.sum()) + thing.score)


def _seen(name: str, thing: DetectedObject, time: str) -> str:
    return _entity(name, thing, thing.pose.frame, thing.pose.transform, _SEEN, time)


def _in_hand(run: Executor, held: HeldObject, time: str) -> str:
    assert run.world is not None
    effector = run.world.robot.description.hand
    link_from_object = Transform((effector.grasp_offset, 0.0, 0.0)) @ held.grasp_from_object
    return _entity(HELD, held.object, effector.frame, link_from_object, _IN_HAND, time)


def _entity(
    name: str, thing: DetectedObject, frame: str, pose: Transform, color: str, time: str
) -> str:
    x, y, z = thing.size
    solid = f'"pose":{pose_text(pose)},"size":{{"x":{x!r},"y":{y!r},"z":{z!r}}},"color":{color}'
    cylinder = thing.shape == "cylinder"
    parts: Iterable[str] = (
        f'"timestamp":{time},"frame_id":{dumps(frame)},"id":{dumps(name)}',
        '"frame_locked":true',
        f'"metadata":[{_pair("category", thing.category)},{_pair("score", f"{thing.score:.3f}")}]',
        f'"cubes":[{"" if cylinder else f"{{{solid}}}"}]',
        f'"cylinders":[{f"{{{solid},{_STRAIGHT}}}" if cylinder else ""}]',
        f'"texts":[{_label(thing, pose)}]',
        _UNUSED,
    )
    return f"{{{','.join(parts)}}}"


_STRAIGHT = '"bottom_scale":1.0,"top_scale":1.0'


def _label(thing: DetectedObject, pose: Transform) -> str:
    above = Transform(pose.apply((0.0, 0.0, thing.size[2])), pose.quaternion)
    return (
        f'{{"pose":{pose_text(above)},"billboard":true,"font_size":0.05,"scale_invariant":false,'
        f'"color":{{"r":1.0,"g":1.0,"b":1.0,"a":1.0}},"text":{dumps(thing.category)}}}'
    )


def _pair(key: str, value: str) -> str:
    return f'{{"key":{dumps(key)},"value":{dumps(value)}}}'
