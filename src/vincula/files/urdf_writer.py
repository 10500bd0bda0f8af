"""Any spatial mechanism as a URDF file: a tree of links, its loops in URDF+ or in a Gepetto file.

URDF puts a link's frame on the axis of its joint, at a joint value of zero: everything is drawn at the
home configuration.  Joints with several axes are chains of joints with one, each called as its axis, so
that every tool that reads URDF can read the tree.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final, Literal
from xml.sax.saxutils import quoteattr

import numpy as np

from vincula.errors import listing
from vincula.files.urdf_joints import UrdfJoints, origin
from vincula.files.urdf_loops import GepettoLoops, PlusLoops
from vincula.files.written import (
    Written,
    bad_names,
    in_space,
    lost_locks,
    reference_frame,
    said_with_commands,
)
from vincula.files.written_couplings import followings
from vincula.files.written_tree import WrittenTree
from vincula.mechanism.parts import GROUND, Frame

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Convention = Literal["plus", "gepetto"]
CLOSING: Final = {
    "plus": ("spherical", "fixed", "revolute", "prismatic", "cylindrical", "universal", "planar"),
    "gepetto": ("spherical", "fixed"),
}
"""Joint types that close loops in each convention; the others end in an added link that is fixed."""


def urdf_data(mechanism: Mechanism, loops: Convention) -> Written:
    """The URDF file of a mechanism, in m and rad; of a planar one its twin in space.

    Args:
        mechanism: The mechanism.
        loops: `plus` for URDF+ (`<loop>`, `<coupling>`), `gepetto` for a side file.
    """
    mechanism, lost = in_space(mechanism)
    writer = _Writer(mechanism, loops)
    text = "\n".join(
        [
            '<?xml version="1.0"?>',
            f"<robot name={quoteattr(mechanism.name)}>",
            *(f"  {line}" for line in writer.lines()),
            "</robot>",
            "",
        ]
    )
    lost += writer.losses()
    beside = {".yaml": writer.loops.side_file()} if isinstance(writer.loops, GepettoLoops) else {}
    called = "a URDF file with a Gepetto file" if loops == "gepetto" else "a URDF+ file"
    return Written(text, lost, writer.changes(), beside, format=called)


class _Writer:
    def __init__(self, mechanism: Mechanism, convention: Convention) -> None:
        self._mechanism = mechanism
        self.tree = WrittenTree(mechanism, CLOSING[convention])
        self._followings, self._left = followings(mechanism)
        names = set(self.tree.poses) | {frame.name for frame in mechanism.frames}
        self.joints = UrdfJoints(self.tree, names, balls=convention == "gepetto")
        loops = PlusLoops if convention == "plus" else GepettoLoops
        self.loops = loops(mechanism, self.tree, self.joints, self._followings, self._left)
        self._point = reference_frame(mechanism, names)

    def lines(self) -> Iterator[str]:
        """Links, joints, loops, motors and frames."""
        yield f"<link name={quoteattr(self.joints.root)}/>"
        following = {f.follower: f for f in self.loops.mimics}
        for branch in self.tree.branches:
            yield from self.joints.branch(branch, following)
        yield from self.loops.lines()
        yield from self._motors()
        frames = list(self._mechanism.frames)
        if self._point is not None and self._point[0] not in {frame.name for frame in frames}:
            frames.append(Frame(*self._point))
        for frame in frames:
            link = self.joints.root if frame.body == GROUND else frame.body
            pose = self.joints.on_link(frame.body, frame.pose)
            place = origin(pose).removeprefix("<origin").removesuffix("/>")
            yield f"<frame name={quoteattr(frame.name)} link={quoteattr(link)}{place}/>"

    def _motors(self) -> Iterator[str]:
        """Transmissions; where nothing is active, a list of joints without a command."""
        mechanism, axes = self._mechanism, set(self.joints.written)
        called = {axis: motor for motor, axis in reversed(list(mechanism.motors.items()))}
        active = [axis for axis in mechanism.active if axis in axes]
        for axis in active:
            motor = quoteattr(called.get(axis, axis))
            yield f"<transmission name={motor}>"
            yield "  <type>transmission_interface/SimpleTransmission</type>"
            yield f"  <joint name={quoteattr(axis)}/>"
            yield f"  <actuator name={motor}/>"
            yield "</transmission>"
        if not active:
            yield '<ros2_control name="passive" type="system">'
            for axis in self.joints.written:
                yield f'  <joint name={quoteattr(axis)}><state_interface name="position"/></joint>'
            yield "</ros2_control>"

    def losses(self) -> Iterator[str]:
        """What would be lost, one sentence a thing."""
        mechanism = self._mechanism
        yield from bad_names(mechanism)
        for contact in mechanism.contacts:
            yield f"contact {contact.name!r}: URDF has no contacts between bodies"
        for coupling in self.loops.left:
            yield f"coupling {coupling.name!r}: the format couples two axes at a constant ratio only"
        for drive in mechanism.drives:
            yield f"motor {drive.name!r} combines axes: the format has motors on single axes only"
        for name in self.tree.free_loops:
            yield f"joint {name!r}: it has all freedoms and holds nothing, so it is not in the file"
        yield from lost_locks(mechanism)

    def changes(self) -> list[str]:
        """What is held in another form, one sentence a thing."""
        mechanism, tree, found = self._mechanism, self.tree, []
        if any(np.any(j.home) for j in mechanism.joints if j.type not in ("spherical", "free")):
            found.append("joint values are displacements from the home configuration")
        several = [b.joint.name for b in tree.branches if self.joints.is_chain(b)]
        if several:
            found.append(f"joints with several axes are one joint an axis: {listing(several, 8)}")
        if self.joints.moved:
            moved = listing(self.joints.moved, 8)
            found.append(f"frames of links are moved to the axis of their joint: {moved}")
        if tree.added:
            found.append(f"loop joints lead to links of their own, which are fixed: {listing(tree.added, 8)}")
        if self.joints.unbounded:
            found.append(
                f"URDF has no one-sided or missing limits: {listing(self.joints.unbounded, 8)} have none "
                "here, and other programs may read zero"
            )
        if mechanism.keyframes:
            found.append(f"the configurations {listing(mechanism.keyframes)} are not in the file")
        found += self.loops.changes()
        said = said_with_commands(mechanism, self._point[0] if self._point else "")
        return [*found, *(text for text in said if "speed" not in text)]
