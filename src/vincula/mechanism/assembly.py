"""From a reduction to the layout of its matrices: every joint, contact, cut, coupling and drive in turn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector, frozen
from vincula.labels import Column, Row, RowKind
from vincula.mechanism.blocked import BlockedRow, contact_rows, joint_rows
from vincula.mechanism.joint_types import Screw, screws
from vincula.mechanism.layout import Layout, RowArrays, ScrewArrays
from vincula.mechanism.parts import GROUND, Coupling
from vincula.mechanism.reduction import CutJoint, Reduction
from vincula.mechanism.residuals import axis_linear

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def lay_out(mechanism: Mechanism) -> Layout:
    """The layout of a mechanism with a reference member; use `mechanism.layout`, which keeps it."""
    builder = _Builder(mechanism, mechanism.reduction)
    builder.add_columns()
    for contact in mechanism.contacts:
        builder.add_contact(contact.name, contact.type, contact.first, contact.second)
    for cut in mechanism.reduction.cuts:
        builder.add_cut(cut)
    return builder.layout()


class _Builder:
    """Collects columns and rows part by part."""

    def __init__(self, mechanism: Mechanism, reduction: Reduction) -> None:
        self.mechanism, self.reduction = mechanism, reduction
        self.frames = mechanism.frame_table
        self.columns: list[Column] = []
        self.of_joint: dict[str, list[int]] = {}
        self._screws: list[tuple[int, Screw]] = []
        self.rows: list[Row] = []
        self._row_names: set[str] = set()
        self._blocked: list[tuple[int, int, int, BlockedRow]] = []
        self._signs: list[dict[int, int]] = []
        self._carried: list[int] = []
        self._points: list[tuple[str, Vector]] = []
        self._cuts: list[tuple[CutJoint, int]] = []

    def add_columns(self) -> None:
        """Columns of every joint that keeps some, then of the drives that are motors."""
        mechanism = self.mechanism
        hidden = {c.joint.name for c in self.reduction.cuts if c.kind == "contact"} | self.reduction.unused
        for joint in mechanism.all_joints:
            if joint.name in hidden:
                continue
            kind = mechanism.type_of(joint)
            frame = self.frames.of_joint[joint.name]
            own = self.of_joint[joint.name] = []
            of_axis = screws(kind, joint.lead, joint.second_axis)
            for axis, linear, screw in zip(kind.axis_names(joint.name), kind.linear, of_axis, strict=True):
                if axis not in mechanism.lock:
                    own.append(len(self.columns))
                    self.columns.append(Column(axis, joint.name, linear))
                    self._screws.append((frame, screw))
        still = Screw(False, np.zeros(mechanism.space.translations), 0.0, 0.0)
        linear_axes = axis_linear(mechanism)
        for drive in mechanism.drives:
            if drive.name in mechanism.active:
                guessed = any(linear_axes[axis] for axis in drive.drives)
                in_metres = guessed if drive.linear is None else drive.linear
                self.columns.append(Column(drive.name, drive.name, in_metres))
                self._screws.append((0, still))

    def add_contact(self, name: str, type_name: str, first: str, second: str) -> None:
        """Rows of a contact, written in the axes of its first side, at the point of its second."""
        frame = self.frames.of_contact[name]
        blocked = contact_rows(type_name, self.mechanism.space)
        self._add_rows(name, "contact", blocked, frame, frame + 1, frame + 1, [(first, 1), (second, -1)])

    def add_cut(self, cut: CutJoint) -> None:
        """Rows of a cut: the joint's own selector, or complete rows (in ground axes) at the cut point."""
        joint, frame = cut.joint, self.frames.of_joint[cut.joint.name]
        sides = [(cut.limb_body, 1), (cut.other_body, -1)]
        if cut.kind == "contact" and self._declared_point(cut) is None:
            kind = self.mechanism.type_of(joint)
            blocked = joint_rows(kind, joint.lead, joint.second_axis)
            point = frame + 1
            self._add_rows(joint.name, cut.role, blocked, frame, point, point, sides)
        else:
            point = self._cut_point(cut, frame + (1 if cut.limb_sign > 0 else 0))
            own = [(k, cut.limb_sign) for k in self.of_joint.get(joint.name, ())]
            self._add_rows(joint.name, cut.role, self._complete_rows(), 0, point, point, sides, own)
        self._cuts.append((cut, point))

    def _complete_rows(self) -> list[BlockedRow]:
        space = self.mechanism.space
        unit = np.eye(space.dimension)
        s = space.translations
        return [
            BlockedRow(name, row[:s], row[s:])
            for name, row in zip(space.wrench_components, unit, strict=True)
        ]

    def _declared_point(self, cut: CutJoint) -> tuple[float, ...] | None:
        reference = self.mechanism.reference
        asked = reference.cuts.get(cut.joint.name) if reference else None
        return None if asked is None else asked.at

    def _cut_point(self, cut: CutJoint, centre: int) -> int:
        """Frame of the declared cut point, which is fixed on the body that is cut; else the centre's."""
        declared, body = self._declared_point(cut), cut.other_body
        if declared is None:
            return centre
        point = np.array(declared, dtype=float)
        if body != GROUND:
            point = self.mechanism.body[body].pose.inverse().apply(point)
        self._points.append((body, point))
        return len(self.frames.carrier) + len(self._points) - 1

    def _add_rows(
        self,
        source: str,
        kind: RowKind,
        blocked: Sequence[BlockedRow],
        frame: int,
        point: int,
        other: int,
        sides: Sequence[tuple[str, int]],
        own: Sequence[tuple[int, int]] = (),
    ) -> None:
        signs = dict(own)
        carried = 0
        for body, side in sides:
            carried -= side * int(self.reduction.carried[body])
            for joint, sign in self.reduction.paths[body]:
                for k in self.of_joint.get(joint, ()):
                    signs[k] = signs.get(k, 0) + side * sign
        for row in blocked:
            self._add_row(source, row.name, kind, row.linear)
            self._blocked.append((frame, point, other, row))
            self._signs.append(signs)
            self._carried.append(carried)

    def _add_row(self, source: str, component: str, kind: RowKind, linear: bool) -> None:
        """Contacts, joints and couplings have name spaces of their own: rows tell them apart."""
        name = f"{source}.{component}"
        if name in self._row_names:
            name = f"{name} ({kind})"
        self._row_names.add(name)
        self.rows.append(Row(name, kind, source, linear))

    def layout(self) -> Layout:
        """Everything as arrays."""
        mechanism = self.mechanism
        index = {column.name: k for k, column in enumerate(self.columns)}
        active = [index[name] for name in mechanism.active]
        passive = [k for k in range(len(self.columns)) if k not in set(active)]
        signs = np.zeros((len(self._signs), len(self.columns)))
        for k, of_row in enumerate(self._signs):
            signs[k, list(of_row)] = list(of_row.values())
        constant, polynomials = self._scalar_rows(index)
        moved = np.abs(signs).sum(axis=1) + np.abs(self._carried)
        groups, path = self._groups([*active, *passive])
        return Layout(
            frames=self.frames.with_points(self._points),
            columns=tuple(self.columns),
            active=np.array(active, dtype=np.intp),
            passive=np.array(passive, dtype=np.intp),
            screws=self._screw_arrays(),
            rows=tuple(self.rows),
            blocked=self._row_arrays(),
            signs=frozen(signs),
            carried=frozen(np.array(self._carried, dtype=float)),
            constant=frozen(constant),
            polynomials=tuple(polynomials),
            cuts=tuple(self._cuts),
            longest=int(moved.max(initial=0.0)),
            groups=groups,
            path=frozen(path),
            group_carried=tuple(self.reduction.carried[name] for name in self.reduction.clusters),
        )

    def _scalar_rows(self, index: dict[str, int]) -> tuple[Matrix, list[tuple[int, Coupling]]]:
        """Rows of couplings and drives, on axes that are neither locked nor unused."""
        mechanism = self.mechanism
        linear = axis_linear(mechanism)
        found: list[dict[str, float]] = []
        polynomials: list[tuple[int, Coupling]] = []
        for coupling in mechanism.couplings:
            if coupling.driver:
                polynomials.append((len(found), coupling))
            self._add_row(coupling.name, "rate", "coupling", any(linear[axis] for axis in coupling.rates))
            found.append({} if coupling.driver else dict(coupling.rates))
        for drive in mechanism.drives:
            if drive.name in mechanism.active:
                self._add_row(drive.name, "rate", "drive", self.columns[index[drive.name]].linear)
                found.append({**drive.drives, drive.name: -1.0})
        constant = np.zeros((len(found), len(self.columns)))
        for k, terms in enumerate(found):
            for name, coefficient in terms.items():
                if name in index:
                    constant[k, index[name]] = coefficient
        return constant, polynomials

    def _screw_arrays(self) -> ScrewArrays:
        s = self.mechanism.space.translations
        found = self._screws
        return ScrewArrays(
            frame=np.array([frame + (1 if w.on_second else 0) for frame, w in found], dtype=np.intp),
            centre=np.array([frame + 1 if frame else 0 for frame, _ in found], dtype=np.intp),
            axis=frozen(np.array([w.axis for _, w in found], dtype=float).reshape(-1, s)),
            turn=frozen(np.array([w.turn for _, w in found], dtype=float)),
            slide=frozen(np.array([w.slide for _, w in found], dtype=float)),
        )

    def _row_arrays(self) -> RowArrays:
        space = self.mechanism.space
        found = self._blocked
        return RowArrays(
            frame=np.array([frame for frame, _, _, _ in found], dtype=np.intp),
            point=np.array([point for _, point, _, _ in found], dtype=np.intp),
            push=frozen(np.array([r.push for *_, r in found], dtype=float).reshape(-1, space.translations)),
            turn=frozen(np.array([r.turn for *_, r in found], dtype=float).reshape(-1, space.rotations)),
            across=tuple(
                (k, other, row.across) for k, (_, _, other, row) in enumerate(found) if row.across is not None
            ),
        )

    def _groups(self, order: Sequence[int]) -> tuple[tuple[str, ...], Matrix]:
        """Rigid groups of bodies, the member's under its own name, and their ways from the roots."""
        clusters = self.reduction.clusters
        member = self.mechanism.reference.body if self.mechanism.reference else ""
        path = np.zeros((len(clusters), len(self.columns)))
        for k, name in enumerate(clusters):
            for joint, sign in self.reduction.paths[name]:
                path[k, self.of_joint.get(joint, [])] = sign
        names = tuple(member if member in bodies else name for name, bodies in clusters.items())
        return names, path[:, list(order)]
