"""Write a robot's summary as text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any


def robot_lines(about: Mapping[str, Any]) -> Iterator[str]:
    """The lines of `momantu-bt robots show`, from `momantu_bt.robots.summary.summary`."""
    size, base, working = about["footprint"], about["base"], about["working"]
    yield f"  file        {about['file'] or 'none: a Python package describes it'}"
    outline = f"{size['length']:g} x {size['width']:g} m"
    yield f"  size        {outline}, {about['height']:g} m high at work"
    yield f"  mass        {about['mass']:.1f} kg"
    speeds = f"{base['linear']:g} m/s, {base['angular']:g} rad/s"
    yield f"  base        {speeds}; frame {about['base_frame']}"
    if working["reach"]:
        near, best, far = working["reach"]
        yield f"  works at    {near:g} to {far:g} m from its centre, best {best:g} m"
    yield f"  simulated   {'yes' if about['simulated'] else 'no: it has no section `simulation`'}"
    if about["parts"]:
        yield "\nParts"
        yield from (f"  {name}: {_part(part)}" for name, part in about["parts"].items())
    yield "\nActuators"
    for name, actuator in about["actuators"].items():
        yield f"  {name}: {', '.join(actuator['joints']) or actuator['kind']}"
    yield "\nJoints"
    for name, limit in about["joint_limits"].items():
        yield f"  {name}: {_limit(limit)}"
    yield "\nSensors"
    yield from (f"  {name}: {_sensor(sensor)}" for name, sensor in about["sensors"].items())
    yield "\nPlanning groups" if about["groups"] else "\nPlanning groups   none: it has no arm"
    for name, group in about["groups"].items():
        reach = f"its tip at most {group['stretched']:.2f} m from its first joint"
        yield f"  {name}: {len(group['joints'])} joints that carry {group['tip']}, {reach}"
    hand = about["end_effector"]
    yield "\nHand"
    if hand is None:
        yield "  none"
    else:
        force = f"closes with up to {hand['max_force']:g} N"
        yield f"  opens to {hand['max_width'] * 1000:g} mm, {force}"
        yield f"  {len(hand['opening'])} finger joints; grasp frame on {hand['frame']}"
    yield f"\nNamed poses   {', '.join(about['named_poses']) or 'none'}"


def _part(part: Mapping[str, Any]) -> str:
    words = [Path(part["file"]).name]
    if part["namespace"]:
        words.append(f"names begin with {part['namespace']}_")
    words.append(f"{part['links']} links, {part['moving_joints']} joints, {part['mass']:.1f} kg")
    if part["mount"]:
        xyz = ", ".join(f"{value:g}" for value in part["mount"]["xyz"])
        words.append(f"on {part['mount']['on']} at ({xyz}) m")
    if part["meshes"]:
        words.append(f"meshes from {part['meshes']}")
    return "; ".join(words)


def _limit(limit: Mapping[str, Any]) -> str:
    endless = limit["lower"] is None
    unit = limit["unit"]
    span = "endless" if endless else f"{limit['lower']:.3g} to {limit['upper']:.3g} {unit}"
    return f"{span}, {limit['velocity']:.3g} {unit}/s, {limit['acceleration']:.3g} {unit}/s2"


def _sensor(sensor: Mapping[str, Any]) -> str:
    kind = sensor["kind"]
    words = [f"{kind}, in {sensor['frame']}, {sensor['height_at_home']:.2f} m high at home"]
    if kind == "camera":
        view = math.degrees(sensor["horizontal_fov"])
        words.append(f"{sensor['width']} x {sensor['picture_height']}, {view:.0f} degrees wide")
        words.append(f"depth {sensor['min_depth']:g} to {sensor['max_depth']:g} m")
        words.append(f"carried by {sensor['carrier']}" if "carrier" in sensor else "fixed")
    if kind == "laser":
        turn = math.degrees(sensor["angle_max"] - sensor["angle_min"])
        words.append(f"{sensor['beams']} beams over {turn:.0f} degrees")
        if "source" in sensor:
            low, high = sensor["band"]
            words.append(f"made from {sensor['source']}, what stands {low:g} to {high:g} m high")
    if kind == "lidar":
        words.append(f"{len(sensor['elevations'])} rings of {sensor['columns']}")
        if "turn" in sensor:
            words.append(f"a turn takes {sensor['turn']:g} s")
    if kind == "imu":
        words.append(f"{sensor['rate']:g} samples a second")
    if kind in ("laser", "lidar"):
        words.append(f"{sensor['range_min']:g} to {sensor['range_max']:g} m")
    return "; ".join(words)
