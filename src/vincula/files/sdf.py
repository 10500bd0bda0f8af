"""SDF files (1.4 to 1.12) as mechanisms: a true graph, one link may be child of several joints.

All joint values are zero in the drawn pose.  A joint whose parent or child is a named frame joins the
two frames: if the links are drawn apart, they are placed by their joints.
"""

from __future__ import annotations

import math
import os
from typing import Final

from vincula.arrays import Vector
from vincula.files.dialects.drake import read_constraint
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.problems import Problems, shown
from vincula.files.report import LoadReport
from vincula.files.robot_graph import WORLD, DraftJoint, RobotDraft
from vincula.files.sdf_frames import SdfFrames
from vincula.files.source import Source, open_source
from vincula.files.xmltree import Element, parse_xml
from vincula.files.xmlvalues import TypedDigits, XmlValues
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Frame
from vincula.mechanism.parts import Limits as JointLimits
from vincula.spatial.poses import Pose

TYPES: Final = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "ball": "spherical",
    "universal": "universal",
    "revolute2": "universal",
    "screw": "screw",
}
"""Joint types of SDF and ours."""

_MODEL_PARTS: Final = {
    "plugin": "plugins are never loaded",
    "static": "read as a moving model",
    "self_collide": "simulator settings",
    "allow_auto_disable": "simulator settings",
    "enable_wind": "simulator settings",
    "gripper": "simulator settings",
}
_LINK_PARTS: Final = (
    "inertial", "visual", "collision", "sensor", "projector", "audio_source", "audio_sink", "battery", "light",
    "particle_emitter", "gravity", "enable_wind", "self_collide", "kinematic", "must_be_base_link",
    "velocity_decay",
)  # fmt: skip
_JOINT_PARTS: Final = ("physics", "sensor", "provide_feedback", "plugin")


def load_sdf(
    path: str | os.PathLike[str] | Source, limits: Limits = DEFAULT_LIMITS
) -> tuple[Mechanism, LoadReport]:
    """The mechanism of an SDF file with one model, at the drawn pose.

    The ground is the world where a joint leads to it, otherwise the link that is nobody's child (of
    several the first).

    Args:
        path: The file, or its text where it is open already.
        limits: How much the file may hold.

    Returns:
        The mechanism, and the report of everything used and ignored.

    Raises:
        FileError: The file cannot be read, or is no mechanism; with file, line, column and element.
        UnsupportedFeatureError: The file holds a part that cannot be represented.
    """
    source = path if isinstance(path, Source) else open_source(path, limits)
    reader = _SdfReader(source)
    reader.read(parse_xml(source, limits))
    return reader.finish(limits), reader.report


class _SdfReader:
    def __init__(self, source: Source) -> None:
        self.problems = Problems(source.file)
        self.digits = TypedDigits()
        self.values = XmlValues(self.problems, self.digits)
        self.report = LoadReport(source.file, "SDF")
        self.draft = RobotDraft(source.file, self.problems, directed=False)
        self.frames = SdfFrames(self.problems, self.values)
        self.version = 0.0

    def read(self, root: Element) -> None:
        """Read the whole document."""
        if root.tag != "sdf":
            self.problems.add(root.place, got=f"<{root.tag}>", expected="<sdf>")
            self.problems.refuse()
        version = root.attributes.get("version", "1.4")
        self.version = (
            float(version.split(".")[1]) if version.startswith("1.") and version[2:].isdigit() else 0.0
        )
        if not 4 <= self.version <= 12:
            self.problems.add(root.place, got=f"version {shown(version)}", expected="1.4 to 1.12")
        models = list(root.find_all("model"))
        for other in root.children:
            if other.tag != "model":
                self.problems.add(
                    other.place, f"<{other.tag}> cannot be read: expected one <model>", unsupported=True
                )
        if len(models) != 1:
            self.problems.add(root.place, got=f"{len(models)} models", expected="one <model> in <sdf>")
        self.problems.refuse_if_any()
        self._model(models[0])

    def finish(self, limits: Limits) -> Mechanism:
        """The mechanism of what was read."""
        if len(self.draft.links) > limits.bodies or len(self.draft.joints) > limits.joints:
            first = next(iter(self.draft.links.values()))
            self.problems.add(first, f"more than {limits.bodies} links or {limits.joints} joints")
        self.draft.digits_length, self.draft.digits_angle = self.digits.length, self.digits.angle
        mechanism = self.draft.mechanism()
        for note in self.draft.notes:
            self.report.note(note)
        return mechanism

    def _model(self, model: Element) -> None:
        self.draft.name = model.name or "model"
        links = [e for e in model.find_all("link") if self._named(e)]
        canonical = model.attributes.get("canonical_link", "") or (links[0].name if links else "")
        self.frames.add_model(model, canonical)
        for link in links:
            self._link(link)
        frames = [e for e in model.find_all("frame") if self._named(e)]
        for frame in frames:
            self.frames.add_frame(frame, frame.name)
        joints = [e for e in model.find_all("joint") if self._named(e)]
        for joint in joints:
            self.frames.add_joint(joint, joint.name, self._end(joint, "child"))
        self.problems.refuse_if_any()
        self.frames.check()
        self.problems.refuse_if_any()
        for frame in frames:
            self._keep_frame(frame)
        for joint in joints:
            self._joint(joint)
        for element in model.children:
            self._other(element)
        self._choose_ground()

    def _named(self, element: Element) -> bool:
        name = self.values.name(element)
        if name and name in self.frames.names:
            self.problems.add(element.place, f"the name {shown(name)} is used twice in the model")
            return False
        return bool(name)

    def _link(self, element: Element) -> None:
        self.frames.add_link(element, element.name)
        self.draft.links[element.name] = element.place
        self.report.used("link", element.name)
        for part in element.children:
            if part.tag in _LINK_PARTS:
                self.report.ignored(part.tag, element.name, "shapes, masses and sensors are not read")
            elif part.tag != "pose":
                self.problems.add(
                    part.place,
                    f"<{part.tag}> is not understood in <link>",
                    name=part.tag,
                    choices=_LINK_PARTS,
                )

    def _keep_frame(self, element: Element) -> None:
        link, pose = self.frames.link_of(element.name), self.frames.in_link(element.name)
        if pose is not None:
            self.draft.frames.append(Frame(element.name, link, pose))
            self.report.used("frame", element.name, f"on {link}")

    def _other(self, element: Element) -> None:
        if element.tag in ("link", "joint", "frame", "pose"):
            return
        if element.tag in _MODEL_PARTS:
            self.report.ignored(element.tag, element.name, _MODEL_PARTS[element.tag])
        elif element.tag.startswith("drake:"):
            read_constraint(element, self.frames, self.draft, self.values, self.report)
        else:
            self.problems.add(
                element.place,
                f"<{element.tag}> cannot be read in <model>; it may hold links, joints or loops",
                name=element.tag,
                choices=("link", "joint", "frame", *_MODEL_PARTS),
                unsupported=element.tag in ("model", "include"),
            )

    def _end(self, joint: Element, tag: str) -> str:
        """The text of `<parent>` or `<child>`."""
        found = list(joint.find_all(tag))
        if len(found) != 1 or not found[0].text:
            self.problems.add(joint.place, f"expected one <{tag}> with the name of a link or frame")
            return ""
        return found[0].text

    def _joint(self, element: Element) -> None:
        written = element.attributes.get("type", "")
        if written not in TYPES:
            self.problems.add(
                element.place, got=f"joint type {shown(written)}", expected="a joint type", name=written,
                choices=TYPES, unsupported=written == "gearbox",
            )  # fmt: skip
            return
        self.values.only(element, ("parent", "child", "pose", "axis", "axis2", "thread_pitch",
                                   "screw_thread_pitch", *_JOINT_PARTS))  # fmt: skip
        parent, child = self._end(element, "parent"), self._end(element, "child")
        for end, tag in ((parent, "parent"), (child, "child")):
            if end not in self.frames.names:
                self.problems.add(
                    element.place, got=f"{tag} {shown(end)}", name=end, choices=self.frames.names
                )
                return
        placed = self._joint_frames(element.name, parent, child)
        axes = self._axes(element, TYPES[written], placed[1])
        if axes is None:
            return
        if WORLD in (self.frames.link_of(parent), self.frames.link_of(child)):
            self.draft.links.setdefault(WORLD, element.place)
        self.draft.joints.append(
            DraftJoint(
                name=element.name, type=TYPES[written], parent=self.frames.link_of(parent),
                child=self.frames.link_of(child), on_parent=placed[0], on_child=placed[1],
                axis=axes[0] if axes else None, second_axis=axes[1] if len(axes) > 1 else None,
                lead=self._lead(element) if written == "screw" else 0.0,
                limits=self._limits(element, written), place=element.place,
            )
        )  # fmt: skip
        self.report.used("joint", element.name, TYPES[written])

    def _joint_frames(self, name: str, parent: str, child: str) -> tuple[Pose, Pose]:
        """Joint frame in the parent link and in the child link."""
        on_child = self.frames.in_link(name) or Pose.identity(3)
        if not self.frames.is_link(parent):
            return self.frames.in_link(parent) or Pose.identity(3), on_child
        base, drawn = self.frames.pose(parent), self.frames.pose(name)
        on_parent = base.inverse() @ drawn if base is not None and drawn is not None else Pose.identity(3)
        return on_parent, on_child

    def _axes(self, element: Element, kind: str, on_child: Pose) -> list[Vector] | None:
        """Unit axes in the joint frame; None after a problem."""
        wanted = {"fixed": (), "spherical": (), "universal": ("axis", "axis2")}.get(kind, ("axis",))
        axes: list[Vector] = []
        for tag in wanted:
            found = next(element.find_all(tag), None)
            if found is None and tag == "axis2":
                self.problems.add(element.place, f"a joint of type {kind} needs <{tag}>")
                return None
            xyz = next(found.find_all("xyz"), None) if found is not None else None
            text = "0 0 1" if xyz is None else xyz.text
            axis = self.values.direction(xyz or element, text, what="xyz")
            if axis is None:
                return None
            axes.append(self._in_joint(element.name, found, xyz, axis))
        return axes

    def _in_joint(self, joint: str, axis: Element | None, xyz: Element | None, vector: Vector) -> Vector:
        """An axis in the joint's frame, from the frame that it is expressed in."""
        frame = xyz.attributes.get("expressed_in", "") if xyz is not None else ""
        flag = next(axis.find_all("use_parent_model_frame"), None) if axis is not None else None
        old = self.version <= 6 and flag is not None and flag.text in ("1", "true")
        if not frame and not old and self.version != 4:
            return vector
        here, there = self.frames.pose(joint), self.frames.pose(frame or "__model__")
        if here is None or there is None:
            self.problems.add(
                (xyz or axis or Element("", {}, "", 0, 0)).place,
                got=f"expressed_in={shown(frame)}", name=frame, choices=self.frames.names,
            )  # fmt: skip
            return vector
        turned: Vector = here.rotation.T @ (there.rotation @ vector)
        return turned

    def _lead(self, element: Element) -> float:
        """Advance a turn: `screw_thread_pitch` [m], or 2 pi over minus `thread_pitch` [rad/m]."""
        for tag in ("screw_thread_pitch", "thread_pitch"):
            found = next(element.find_all(tag), None)
            if found is None:
                continue
            value = self.values.numbers(found, found.text, 1, what=tag)
            if value is None or value[0] == 0.0:
                self.problems.add(
                    found.place, got=f"{tag} {shown(found.text)}", expected="a number, not zero"
                )
                return 1.0
            pitch = float(value[0])
            return pitch if tag == "screw_thread_pitch" else -2 * math.pi / pitch
        self.problems.add(element.place, "a screw joint needs <screw_thread_pitch>")
        return 1.0

    def _limits(self, element: Element, written: str) -> tuple[JointLimits, ...]:
        """Limits by axis; an effort limit of zero marks a joint without a motor, as in Drake."""
        limits = []
        for tag in ("axis", "axis2"):
            axis = next(element.find_all(tag), None)
            limit = next(axis.find_all("limit"), None) if axis is not None else None
            if axis is None:
                continue
            got: dict[str, float | None] = {}
            for key in ("lower", "upper", "velocity", "effort"):
                found = next(limit.find_all(key), None) if limit is not None else None
                value = self.values.numbers(found, found.text, 1, what=key) if found is not None else None
                got[key] = None if value is None else float(value[0])
            if got["effort"] == 0.0:
                self.draft.passive.add(element.name)
                self.report.note(f"{element.name} has an effort limit of zero: it is passive")
            lower, upper = (_bound(got[key]) for key in ("lower", "upper"))
            if lower is not None and upper is not None and lower > upper:
                self.problems.add(axis.place, f"lower limit {lower:g} is above upper limit {upper:g}")
                lower = upper = None
            if written == "continuous":
                lower = upper = None
            limits.append(JointLimits(lower, upper, _positive(got["velocity"]), _positive(got["effort"])))
        return tuple(limits)

    def _choose_ground(self) -> None:
        if WORLD in self.draft.links or not self.draft.links:
            self.draft.ground = WORLD if WORLD in self.draft.links else None
            return
        children = {j.child for j in self.draft.joints if not j.closure}
        roots = [link for link in self.draft.links if link not in children] or list(self.draft.links)
        self.draft.ground = roots[0]
        if len(roots) > 1:
            self.draft.notes.append(
                f"no joint leads to the world: {roots[0]} is taken for the ground ({', '.join(roots[1:])} "
                "are children of no joint either)"
            )


def _bound(value: float | None) -> float | None:
    """SDF writes 1e16 for no limit."""
    return None if value is None or abs(value) >= 1e16 else value


def _positive(value: float | None) -> float | None:
    """SDF writes -1 for no limit."""
    return value if value is not None and value > 0.0 else None
