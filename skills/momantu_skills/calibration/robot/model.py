"""What a robot with certain zeros, camera and wheels would see, and the derivatives of that."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_skills.calibration.poses import rotations_of
from momantu_skills.calibration.robot.parameters import Parameters, columns
from momantu_skills.calibration.robot.views import Views
from momantu_skills.manipulation.model.batched import BatchedChain

with lazily():
    import torch

if TYPE_CHECKING:
    from torch import Tensor

_NEAREST = 0.05
"""m; a corner that would lie nearer, or behind the camera, is taken to lie there."""
_WAY_NOISE = (0.001, 0.01)
_TURN_NOISE = (0.002, 0.01)
"""Standard deviations of odometry from stand to stand: m or rad, and a share of the motion."""


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """What is estimated. told: (P,), as `Parameters`; the rest only explains the views.

    tags: (T, 4, 4), the pose of each tag in the hand's frame or in odometry's; stands: (S, 3).
    """

    told: Array
    tags: Array
    stands: Array

    def moved(self, step: Array) -> State:
        """The state after a step in all its parameters (P + 6 T + 3 (S - 1),)."""
        count, tags = len(self.told), len(self.tags)
        twists = step[count : count + 6 * tags].reshape(-1, 6)
        moves = np.tile(np.eye(4), (tags, 1, 1))
        moves[:, :3, :3] = rotations_of(twists[:, :3])
        moves[:, :3, 3] = twists[:, 3:]
        stands = self.stands.copy()
        stands[1:] += step[count + 6 * tags :].reshape(-1, 3)
        return State(self.told + step[:count], self.tags @ moves, stands)


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A robot's kinematics and its views. in_hand: (T,), which tags move with the hand."""

    views: Views
    parameters: Parameters
    camera: BatchedChain
    hand: BatchedChain | None
    in_hand: NDArray[np.bool_]

    def of(self, mask: NDArray[np.bool_] | NDArray[np.intp]) -> Model:
        """The same robot with some of the sightings: those of a mask, or at indices."""
        return replace(self, views=self.views.chosen(mask))

    def size(self, state: State) -> int:
        """How many numbers are estimated."""
        return len(state.told) + 6 * len(state.tags) + 3 * (len(state.stands) - 1)

    def pixels(self, state: State) -> Array:
        """What each sighting is off, (N, 4, 2) px: expected minus seen."""
        with torch.no_grad():
            return np.asarray(self._off(state, *self._leaves(state)).numpy())

    def depths(self, state: State) -> Array:
        """How far each tag is along the optical axis, (N,) m."""
        with torch.no_grad():
            told, _, stand = self._leaves(state)
            tag = torch.zeros(len(self.views), 6, dtype=torch.float64)
            return np.asarray(self._corners(state, told, tag, stand)[..., 2].mean(1).numpy())

    def linearised(self, state: State) -> tuple[Array, Array]:
        """What the sightings are off, (8 N,) px, and its derivatives (8 N, size).

        Each sighting stands eight times, once for each number, so that one pass gives all.
        """
        count = len(self.views)
        eight = self.of(np.repeat(np.arange(count), 8))
        leaves = eight._leaves(state)
        every = torch.arange(8 * count)
        off = eight._off(state, *leaves).reshape(8 * count, 8)[every, every % 8]
        parts = torch.autograd.grad(off.sum(), leaves)
        told, tag, stand = (np.asarray(part.numpy()).reshape(count, 8, -1) for part in parts)
        return np.asarray(off.detach().numpy()), self._dense(state, told, tag, stand)

    def driven(self, state: State) -> tuple[Array, Array]:
        """What the stands are off from odometry in its standard deviations, and its derivatives."""
        if not self.views.drives:
            return np.zeros(0), np.zeros((0, self.size(state)))
        steps, noise = self._steps()
        wheels = torch.tensor(
            np.tile(state.told[self.parameters.wheels], (len(steps), 1)), requires_grad=True
        )
        start = torch.tensor(state.stands[:-1], requires_grad=True)
        end = torch.tensor(state.stands[1:], requires_grad=True)
        moved = _relative(start, end)
        expected = _composed(steps, wheels, self.parameters.track)
        off = torch.cat([(moved - expected)[:, :2], _wrapped((moved - expected)[:, 2:])], 1) / noise
        made = np.zeros((*off.shape, self.size(state)))
        first = len(state.told) + 6 * len(state.tags)
        for k in range(3):
            parts = torch.autograd.grad(off[:, k].sum(), (wheels, start, end), retain_graph=True)
            made[:, k, self.parameters.wheels] = parts[0].numpy()
            for i in range(len(off)):
                if i:
                    made[i, k, first + 3 * (i - 1) : first + 3 * i] += parts[1][i].numpy()
                made[i, k, first + 3 * i : first + 3 * i + 3] += parts[2][i].numpy()
        return np.asarray(off.detach().numpy()).ravel(), made.reshape(-1, made.shape[-1])

    def _steps(self) -> tuple[Tensor, Tensor]:
        """Steps (D, most, 3), zeros after the last one, and noise (D, 3)."""
        drives = self.views.drives
        steps = np.zeros((len(drives), max(len(drive.steps) for drive in drives), 3))
        for made, drive in zip(steps, drives, strict=True):
            made[: len(drive.steps)] = drive.steps
        way = np.hypot(steps[..., 0], steps[..., 1]).sum(1)
        turn = np.abs(steps[..., 2]).sum(1)
        place = _WAY_NOISE[0] + _WAY_NOISE[1] * way
        noise = np.stack([place, place, _TURN_NOISE[0] + _TURN_NOISE[1] * turn], 1)
        return torch.tensor(steps), torch.tensor(noise)

    def _leaves(self, state: State) -> tuple[Tensor, Tensor, Tensor]:
        """Told parameters, small moves of the tag and stands, a row for each sighting."""
        count = len(self.views)
        return (
            torch.tensor(np.tile(state.told, (count, 1)), requires_grad=True),
            torch.zeros(count, 6, dtype=torch.float64, requires_grad=True),
            torch.tensor(state.stands[self.views.stands], requires_grad=True),
        )

    def _off(self, state: State, told: Tensor, tag: Tensor, stand: Tensor) -> Tensor:
        points = self._corners(state, told, tag, stand)
        lens = torch.as_tensor(self.views.intrinsics)[:, None, :]
        scale = torch.exp(told[:, self.parameters.lens])[:, None, None]
        ahead = points[..., 2:].clamp(min=_NEAREST)
        expected = lens[..., :2] * scale * points[..., :2] / ahead + lens[..., 2:]
        return expected - torch.as_tensor(self.views.corners)

    def _corners(self, state: State, told: Tensor, tag: Tensor, stand: Tensor) -> Tensor:
        """The tags' corners (N, 4, 3) in the camera's frame, m."""
        views, parameters = self.views, self.parameters
        positions = torch.as_tensor(views.positions) + told[:, : len(parameters.joints)]
        at = columns(self.camera.names, views.joints)
        mount = torch.linalg.matrix_exp(_twists(told[:, parameters.mount]))
        base_from_camera = self.camera.base_from_frame(positions[:, at]) @ mount
        carrier = _inverse(_planar(stand))
        if self.hand is not None and self.in_hand.any():
            at = columns(self.hand.names, views.joints)
            held = torch.as_tensor(self.in_hand[views.tags])[:, None, None]
            carrier = torch.where(held, self.hand.base_from_frame(positions[:, at]), carrier)
        move = torch.eye(4, dtype=torch.float64) + _twists(tag)
        base_from_tag = carrier @ torch.as_tensor(state.tags[views.tags]) @ move
        camera_from_tag = _inverse(base_from_camera) @ base_from_tag
        models = torch.as_tensor(views.models)
        return models @ camera_from_tag[:, :3, :3].mT + camera_from_tag[:, None, :3, 3]

    def _dense(self, state: State, told: Array, tag: Array, stand: Array) -> Array:
        """Derivatives (8 N, size) from those (N, 8, ...) of each sighting's own parameters."""
        views, count = self.views, len(state.told)
        made = np.zeros((len(views), 8, self.size(state)))
        made[..., :count] = told
        first = count + 6 * len(state.tags)
        for i, (k, s) in enumerate(zip(views.tags, views.stands, strict=True)):
            made[i, :, count + 6 * k : count + 6 * k + 6] = tag[i]
            if s:
                made[i, :, first + 3 * (s - 1) : first + 3 * s] = stand[i]
        return made.reshape(-1, made.shape[-1])


def _twists(values: Tensor) -> Tensor:
    """Matrices (n, 4, 4) whose exponentials turn by values[:, :3] and shift by the rest."""
    x, y, z, *shift = values.unbind(1)
    zero = torch.zeros_like(x)
    rows = [
        torch.stack([zero, -z, y, shift[0]], 1),
        torch.stack([z, zero, -x, shift[1]], 1),
        torch.stack([-y, x, zero, shift[2]], 1),
        torch.stack([zero] * 4, 1),
    ]
    return torch.stack(rows, 1)


def _planar(poses: Tensor) -> Tensor:
    """Matrices (n, 4, 4) of poses x, y, yaw."""
    x, y, yaw = poses.unbind(1)
    c, s, zero, one = torch.cos(yaw), torch.sin(yaw), torch.zeros_like(x), torch.ones_like(x)
    rows = [[c, -s, zero, x], [s, c, zero, y], [zero, zero, one, zero], [zero, zero, zero, one]]
    return torch.stack([torch.stack(row, 1) for row in rows], 1)


def _inverse(poses: Tensor) -> Tensor:
    turned = poses[:, :3, :3].mT
    top = torch.cat([turned, -turned @ poses[:, :3, 3:]], 2)
    return torch.cat([top, poses[:, 3:]], 1)


def _relative(start: Tensor, end: Tensor) -> Tensor:
    """The pose (n, 3) of `end` as seen from `start`."""
    c, s = torch.cos(start[:, 2]), torch.sin(start[:, 2])
    x, y = (end - start)[:, 0], (end - start)[:, 1]
    return torch.stack([c * x + s * y, c * y - s * x, _wrapped((end - start)[:, 2])], 1)


def _wrapped(angles: Tensor) -> Tensor:
    return torch.remainder(angles + torch.pi, 2 * torch.pi) - torch.pi


def _composed(steps: Tensor, wheels: Tensor, track: float) -> Tensor:
    """Where the steps (D, K, 3) of odometry lead with other wheels (D, 3): poses (D, 3).

    Each step is driven at constant speeds.
    """
    radius, wider, larger = (each[:, None] for each in wheels.unbind(1))
    x, y, yaw = steps.unbind(2)
    half = 0.5 * yaw
    # From the chord to the arc: x, y are the arc's speeds times sinc, turned by half the angle.
    scale = 1.0 / torch.sinc(half / torch.pi)
    ahead = scale * (torch.cos(half) * x + torch.sin(half) * y)
    aside = scale * (torch.cos(half) * y - torch.sin(half) * x)
    way = (1 + radius) * ahead + 0.25 * larger * track * yaw
    turn = ((1 + radius) * yaw + larger * ahead / track) / (1 + wider)
    aside = (1 + radius) * aside
    shrink, half = torch.sinc(0.5 * turn / torch.pi), 0.5 * turn
    dx = shrink * (torch.cos(half) * way - torch.sin(half) * aside)
    dy = shrink * (torch.sin(half) * way + torch.cos(half) * aside)
    before = torch.cumsum(turn, 1) - turn
    c, s = torch.cos(before), torch.sin(before)
    return torch.stack([(c * dx - s * dy).sum(1), (s * dx + c * dy).sum(1), turn.sum(1)], 1)
