"""All frames of joints and contacts at once: which body carries each, and where they are.

A mechanism has two frames a joint or contact; stacked in arrays they are carried along with the
bodies by one multiplication, at every configuration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.mechanism.parts import GROUND, ContactPart, Joint
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class PlacedFrames:
    """Frames in ground axes at one configuration.

    Attributes:
        rotation: k x s x s rotation matrices.
        position: k x s positions [m].
    """

    rotation: NDArray[np.float64]
    position: NDArray[np.float64]

    def pose(self, index: int) -> Pose:
        """One frame."""
        return Pose(self.rotation[index], self.position[index])

    def coincide(self, one: Sequence[int] | Indices, two: Sequence[int] | Indices) -> NDArray[np.bool_]:
        """For every pair of frames, whether they are equal to the last bit."""
        same_place = (self.position[one] == self.position[two]).all(axis=1)
        same_turn = (self.rotation[one] == self.rotation[two]).all(axis=(1, 2))
        return np.asarray(same_place & same_turn)


@dataclass(frozen=True, slots=True, eq=False)
class FrameTable:
    """Frames on bodies, as they are at every configuration.

    Frame 0 is that of the ground; then come frames A and B of every joint, then of every contact,
    then whatever was added.

    Attributes:
        bodies: Names of the bodies, the ground first.
        carrier: For every frame the index of its body.
        rotation: k x s x s rotations in the body frames.
        position: k x s positions in the body frames [m].
        of_joint: Index of frame A by joint name; frame B is the next.
        of_contact: The same for contacts.
    """

    bodies: tuple[str, ...]
    carrier: Indices
    rotation: NDArray[np.float64]
    position: NDArray[np.float64]
    of_joint: Mapping[str, int]
    of_contact: Mapping[str, int]

    @staticmethod
    def of_mechanism(mechanism: Mechanism) -> FrameTable:
        """The table of a mechanism; use `mechanism.frame_table`, which keeps it."""
        parts: tuple[Joint | ContactPart, ...] = (*mechanism.all_joints, *mechanism.contacts)
        first_contact = 1 + 2 * len(mechanism.all_joints)
        carried = [(GROUND, Pose.identity(mechanism.space.translations))]
        for part in parts:
            carried += [(part.first, part.frame_on_first), (part.second, part.frame_on_second)]
        return FrameTable(
            **_stacked((GROUND, *mechanism.body), carried),
            bodies=(GROUND, *mechanism.body),
            of_joint={joint.name: 1 + 2 * k for k, joint in enumerate(mechanism.all_joints)},
            of_contact={c.name: first_contact + 2 * k for k, c in enumerate(mechanism.contacts)},
        )

    def with_points(self, points: Sequence[tuple[str, Vector]]) -> FrameTable:
        """The same table with further points, each given by its body and its place there [m]."""
        if not points:
            return self
        more = _stacked(self.bodies, [(body, Pose.at(point)) for body, point in points])
        return FrameTable(
            bodies=self.bodies,
            carrier=np.concatenate([self.carrier, more["carrier"]]),
            rotation=np.concatenate([self.rotation, more["rotation"]]),
            position=np.concatenate([self.position, more["position"]]),
            of_joint=self.of_joint,
            of_contact=self.of_contact,
        )

    def placed(self, poses: Mapping[str, Pose]) -> PlacedFrames:
        """The frames in ground axes, the bodies being at the given poses."""
        body_rotation = np.array([poses[name].rotation for name in self.bodies])[self.carrier]
        body_position = np.array([poses[name].position for name in self.bodies])[self.carrier]
        moved = (body_rotation @ self.position[:, :, None])[:, :, 0]
        return PlacedFrames(body_rotation @ self.rotation, moved + body_position)


def _stacked(bodies: Sequence[str], carried: Sequence[tuple[str, Pose]]) -> dict[str, NDArray]:  # type: ignore[type-arg]
    index = {name: k for k, name in enumerate(bodies)}
    return {
        "carrier": np.array([index[body] for body, _ in carried], dtype=np.intp),
        "rotation": np.array([pose.rotation for _, pose in carried]),
        "position": np.array([pose.position for _, pose in carried]),
    }
