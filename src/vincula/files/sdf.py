"""SDF files (1.4 to 1.12) as mechanisms: a true graph, one link may be child of several joints.

All joint values are zero in the drawn pose.  A joint whose parent or child is a named frame joins the
two frames: if the links are drawn apart, they are placed by their joints.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Final

from vincula.files.contents import account_elements
from vincula.files.dialects.drake import read_constraint
from vincula.files.dialects.unknown import read_unknown
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.packages import Packages, record_meshes
from vincula.files.problems import Problems, shown
from vincula.files.report import LoadReport
from vincula.files.robot_graph import WORLD, RobotDraft
from vincula.files.sdf_frames import MODEL, SdfFrames
from vincula.files.sdf_joints import KNOWN_IN_JOINTS, SdfJoints, end_of
from vincula.files.sdf_models import only_model
from vincula.files.snapping import Snapping
from vincula.files.source import Source, open_source
from vincula.files.unclosed import note_unclosed_ends
from vincula.files.xmltree import Element, parse_xml
from vincula.files.xmlvalues import TypedDigits, XmlValues
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Frame

_MODEL_PARTS: Final = {
    "plugin": "plugins are never loaded",
    "static": "read as a moving model",
    "self_collide": "simulator settings",
    "allow_auto_disable": "simulator settings",
    "enable_wind": "simulator settings",
    "gripper": "simulator settings",
}
_LINK_PARTS: Final = (
    "inertial", "visual", "collision", "sensor", "projector", "audio_source", "audio_sink", "battery",
    "light", "particle_emitter", "gravity", "enable_wind", "self_collide", "kinematic", "must_be_base_link",
    "velocity_decay", "plugin",
)  # fmt: skip


def load_sdf(
    path: str | os.PathLike[str] | Source,
    limits: Limits = DEFAULT_LIMITS,
    *,
    snapping: Snapping | None = None,
    packages: Packages | None = None,
) -> tuple[Mechanism, LoadReport]:
    """The mechanism of an SDF file with one model (in a world: one that is not static), at the drawn pose.

    The ground is the world where a joint leads to it, otherwise the link that is nobody's child (of
    several the first).

    Args:
        path: The file, or its text where it is open already.
        limits: How much the file may hold.
        snapping: Replaces numbers of the file by what they mean.
        packages: Where `package://` leads; by default to the packages of the environment.

    Returns:
        The mechanism, and the report of everything used and ignored.

    Raises:
        FileError: The file cannot be read, or is no mechanism; with file, line, column and element.
        UnsupportedFeatureError: The file holds a part that cannot be represented.
    """
    source = path if isinstance(path, Source) else open_source(path, limits)
    reader = _SdfReader(source)
    root = parse_xml(source, limits, reader.report)
    if snapping is not None:
        snapping.sdf(root)
    reader.read(root)
    record_meshes(root, source.path, packages or Packages.of(), reader.report)
    mechanism = reader.finish(limits)
    account_elements(root, reader.report)
    return mechanism, reader.report


class _SdfReader:
    def __init__(self, source: Source) -> None:
        self.problems = Problems(source.file)
        self.digits = TypedDigits()
        self.values = XmlValues(self.problems, self.digits)
        self.report = LoadReport(source.file, "SDF")
        self.draft = RobotDraft(source.file, self.problems, directed=False)
        self.frames = SdfFrames(self.problems, self.values)
        self.names = {""}
        self.version = 0.0
        self.unknown: list[Element] = []

    def read(self, root: Element) -> None:
        """Read the whole document."""
        if root.tag != "sdf":
            self.problems.add(root.place, got=f"<{root.tag}>", expected="<sdf>")
            self.problems.refuse()
        version = root.get("version", "1.4")
        self.version = (
            float(version.split(".")[1]) if version.startswith("1.") and version[2:].isdigit() else 0.0
        )
        if not 4 <= self.version <= 12:
            self.problems.add(root.place, got=f"version {shown(version)}", expected="1.4 to 1.12")
        self.problems.refuse_if_any()
        model, unknown = only_model(root, self.problems, self.report)
        self.unknown += unknown
        self._model(model)
        for element in self.unknown:
            read_unknown(element, self.draft, self.values, self.report, _known_in(element))

    def finish(self, limits: Limits) -> Mechanism:
        """The mechanism of what was read."""
        if len(self.draft.links) > limits.bodies or len(self.draft.joints) > limits.joints:
            first = next(iter(self.draft.links.values()))
            self.problems.add(first, f"more than {limits.bodies} links or {limits.joints} joints")
        self.draft.digits_length, self.draft.digits_angle = self.digits.length, self.digits.angle
        note_unclosed_ends(self.draft, "An overlay (a native file with base:) does: closures, frames: [{}]")
        mechanism = self.draft.mechanism()
        for note in self.draft.notes:
            self.report.note(note)
        return mechanism

    def _model(self, model: Element) -> None:
        self.draft.name = model.name or "model"
        links = [e for e in model.find_all("link") if self._named(e)]
        canonical = model.get("canonical_link", "") or (links[0].name if links else "")
        self.frames.add_model(model, canonical)
        for link in links:
            self._link(link)
        frames = [e for e in model.find_all("frame") if self._named(e)]
        for frame in frames:
            self.frames.add_frame(frame, frame.name)
        joints = [e for e in model.find_all("joint") if self._named(e)]
        known = {*self.frames.names, *(joint.name for joint in joints)}
        for joint in joints:
            child = end_of(joint, "child", self.values)
            if child and child not in known:
                self.problems.add(joint.place, got=f"child {shown(child)}", name=child, choices=known)
            self.frames.add_joint(joint, joint.name, child if child in known else MODEL)
        self.problems.refuse_if_any()
        self.frames.check()
        self.problems.refuse_if_any()
        for frame in frames:
            self._keep_frame(frame)
        reader = SdfJoints(self.frames, self.draft, self.values, self.report, self.version)
        for joint in joints:
            reader.read(joint)
        reader.couple()
        self.unknown += reader.unknown
        for element in model.children:
            self._other(element)
        self._choose_ground()

    def _named(self, element: Element) -> bool:
        name = self.values.name(element)
        if name in self.names:
            self.problems.add(element.place, f"the name {shown(name)} is used twice in the model")
            return False
        self.names.add(name)
        return bool(name)

    def _link(self, element: Element) -> None:
        self.frames.add_link(element, element.name)
        self.draft.links[element.name] = element.place
        self.report.used("link", element.name)
        for part in element.children:
            if part.tag in _LINK_PARTS:
                self.report.ignored(
                    part.tag, element.name, "shapes, masses and sensors are not read", of=part
                )
            elif part.tag != "pose":
                self.unknown.append(part)

    def _keep_frame(self, element: Element) -> None:
        link, pose = self.frames.link_of(element.name), self.frames.in_link(element.name)
        if pose is not None:
            self.draft.frames.append(Frame(element.name, link, pose))
            self.report.used("frame", element.name, f"on {link}")

    def _other(self, element: Element) -> None:
        if element.tag in ("link", "joint", "frame", "pose"):
            return
        if element.tag in _MODEL_PARTS:
            self.report.ignored(element.tag, element.name, _MODEL_PARTS[element.tag], of=element)
        elif element.tag.startswith("drake:"):
            read_constraint(element, self.frames, self.draft, self.values, self.report)
        elif element.tag in ("model", "include"):
            self.problems.add(
                element.place,
                f"<{element.tag}> cannot be read in <model>: it holds links and joints of its own",
                unsupported=True,
            )
        else:
            self.unknown.append(element)

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


def _known_in(element: Element) -> Iterable[str]:
    """What could stand in the place of an element that nobody knows."""
    around = element.parent.tag if element.parent is not None else ""
    known = {"model": ("link", "joint", "frame", *_MODEL_PARTS), "link": ("pose", *_LINK_PARTS)}
    return known.get(around, KNOWN_IN_JOINTS.get(around, ("model",)))
