"""Numbers for a reduction at a configuration: J_a, J_p and G with named rows and columns.

Every joint axis is written once, as a twist at the reference point in ground axes.  A cut then needs
only a small matrix that carries twists to its point and keeps the blocked directions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector, frozen
from vincula.errors import ClosureError, MissingReferenceError
from vincula.labels import BodyMotions, Column, Cut, Row, Uncertainty
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.joint_types import axis_twists, blocked_directions
from vincula.mechanism.kinematics import body_poses, part_frames, reference_position
from vincula.mechanism.motor_weights import weights_of_motors
from vincula.mechanism.parts import GROUND, ContactPart
from vincula.mechanism.reduction import CutJoint, Reduction
from vincula.mechanism.residuals import CLOSED, axis_linear, axis_values, loop_residuals
from vincula.model import LinearModel
from vincula.spatial.poses import Pose
from vincula.spatial.selectors import component_names, contact_components, selector
from vincula.spatial.twists import block_rotation, transport

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def linearize(mechanism: Mechanism, q: Configuration) -> LinearModel:
    """The linear model of a mechanism at a closed configuration: eqs. (1) and (15)."""
    reference = mechanism.reference
    if reference is None:
        raise MissingReferenceError(body.name for body in mechanism.bodies)
    poses = body_poses(mechanism, q)
    residual = _closed(mechanism, q, poses)
    builder = _Builder(mechanism, mechanism.reduction, poses)
    builder.add_all(q)
    jacobian, member = builder.matrices()
    if reference.axes == "body":
        member = member @ block_rotation(poses[reference.body].rotation)
    active = [builder.index[name] for name in mechanism.active]
    chosen = set(active)
    passive = [i for i in range(len(builder.columns)) if i not in chosen]
    precision = mechanism.precision
    return LinearModel(
        jacobian_active=jacobian[:, active],
        jacobian_passive=jacobian[:, passive],
        grasp=member.T,
        rows=tuple(builder.rows),
        motors=tuple(builder.columns[i] for i in active),
        passives=tuple(builder.columns[i] for i in passive),
        space=mechanism.space,
        length=mechanism.length,
        uncertainty=Uncertainty(
            residual,
            precision.digits_length,
            precision.digits_angle,
            precision.tolerance_length,
            precision.tolerance_angle,
            builder.curvature(),
        ),
        mechanism=mechanism.name,
        reference=reference.label or reference.body,
        frame="ground axes" if reference.axes == "ground" else f"axes of {reference.body}",
        cuts=tuple(builder.cuts),
        notes=(*mechanism.notes, *mechanism.reduction.notes),
        weights=weights_of_motors(mechanism),
        motions=builder.motions([*active, *passive]),
    )


def _closed(mechanism: Mechanism, q: Configuration, poses: Mapping[str, Pose]) -> float:
    """Largest residual, refusing open loops."""
    residuals = loop_residuals(mechanism, q, poses)
    if not residuals:
        return 0.0
    worst = max(residuals, key=lambda r: r.gap)
    if not worst.gap <= CLOSED * mechanism.length:
        others = sum(1 for r in residuals if r.gap > CLOSED * mechanism.length) - 1
        more = f" ({others} more open)" if others else ""
        raise ClosureError(
            f"{worst}{more}: the configuration does not satisfy the mechanism, and nothing was moved. "
            "Give values for all joints of the loop that close it, or ask for closing.",
            loop=worst.name,
            gap=worst.gap,
            residuals=residuals,
        )
    return worst.gap


@dataclass(frozen=True, slots=True)
class _Block:
    """Rows of one cut: matrix on twists at the reference point, and the bodies on both sides."""

    matrix: Matrix
    terms: tuple[tuple[str, int], ...]
    own: tuple[str, int] | None
    carried: int


class _Builder:
    """Collects columns and row blocks, then fills the matrices."""

    def __init__(self, mechanism: Mechanism, reduction: Reduction, poses: Mapping[str, Pose]) -> None:
        self.mechanism, self.reduction, self.poses = mechanism, reduction, poses
        self.origin = reference_position(mechanism, poses)
        self.columns: list[Column] = []
        self.index: dict[str, int] = {}
        self.of_joint: dict[str, list[int]] = {}
        self.twists: list[Matrix] = []
        self.rows: list[Row] = []
        self.cuts: list[Cut] = []
        self._blocks: list[_Block] = []
        self._scalar_rows: list[dict[str, float]] = []
        self._path_columns: dict[str, tuple[list[int], list[int]]] = {}

    def add_all(self, q: Configuration) -> None:
        """Columns of every joint that has some, then rows of contacts, cuts, couplings and drives."""
        hidden = {c.joint.name for c in self.reduction.cuts if c.kind == "contact"} | self.reduction.unused
        for joint in self.mechanism.all_joints:
            if joint.name not in hidden:
                self._add_joint(joint.name)
        for contact in self.reduction.contacts:
            self._add_contact(contact)
        for cut in self.reduction.cuts:
            self._add_cut(cut)
        self._add_couplings(q)
        self._add_drives()

    def _add_joint(self, name: str) -> None:
        joint = self.mechanism.joint[name]
        kind = self.mechanism.type_of(joint)
        indices: list[int] = []
        if kind.axes:
            first, second = part_frames(joint, self.poses)
            twists = axis_twists(kind, first, second, joint.lead, joint.second_axis, self.origin)
            for k, axis in enumerate(kind.axis_names(name)):
                if axis in self.mechanism.lock:
                    continue
                indices.append(self._add_column(Column(axis, name, kind.linear[k]), twists[:, k]))
        self.of_joint[name] = indices

    def _add_column(self, column: Column, twist: Vector) -> int:
        self.index[column.name] = len(self.columns)
        self.columns.append(column)
        self.twists.append(twist)
        return len(self.columns) - 1

    def _rows_at(self, selected: Matrix, point: Vector) -> Matrix:
        """Rows on twists at `point`, as rows on twists at the reference point."""
        return selected @ transport(point - self.origin)

    def _add_contact(self, contact: ContactPart) -> None:
        first, _ = part_frames(contact, self.poses)
        space = self.mechanism.space
        components = contact_components(contact.type, space)
        selected = selector(components, space) @ block_rotation(first.rotation.T)
        names = component_names(components, space)
        for name in names:
            self.rows.append(Row(f"{contact.name}.{name}", "contact", contact.name, name[0] == "f"))
        carried = self.reduction.carried
        self._blocks.append(
            _Block(
                self._rows_at(selected, first.position),
                ((contact.first, 1), (contact.second, -1)),
                None,
                int(carried[contact.second]) - int(carried[contact.first]),
            )
        )

    def _add_cut(self, cut: CutJoint) -> None:
        joint = cut.joint
        first, second = part_frames(joint, self.poses)
        other = joint.second if cut.limb_body == joint.first else joint.first
        terms = ((cut.limb_body, 1), (other, -1))
        carried = int(self.reduction.carried[other]) - int(self.reduction.carried[cut.limb_body])
        if cut.kind == "contact":
            kind = self.mechanism.type_of(joint)
            blocked = blocked_directions(kind, first, second, joint.lead, joint.second_axis)
            point, matrix, names, linear = first.position, blocked.matrix, blocked.names, blocked.linear
            own = None
        else:
            point = self._cut_point(cut, other, first)
            space = self.mechanism.space
            matrix, names = np.eye(space.dimension), space.wrench_components
            linear = tuple(k < space.translations for k in range(space.dimension))
            own = (joint.name, cut.limb_sign)
        for name, flag in zip(names, linear, strict=True):
            self.rows.append(Row(f"{joint.name}.{name}", cut.role, joint.name, flag))
        self.cuts.append(Cut(joint.name, cut.kind, cut.role, tuple(float(x) for x in point)))
        self._blocks.append(_Block(self._rows_at(matrix, point), terms, own, carried))

    def _cut_point(self, cut: CutJoint, other: str, first: Pose) -> Vector:
        """The declared cut point, which is fixed on the body that is cut; else the joint's centre."""
        reference = self.mechanism.reference
        asked = reference.cuts.get(cut.joint.name) if reference else None
        if asked is None or asked.at is None:
            return first.position
        point = np.array(asked.at, dtype=float)
        if other == GROUND:
            return point
        home = self.mechanism.body[other].pose
        now = self.poses[other]
        return point if now is home else now.apply(home.inverse().apply(point))

    def _add_couplings(self, q: Configuration) -> None:
        if not self.mechanism.couplings:
            return
        values, home = axis_values(self.mechanism, q), axis_values(self.mechanism, self.mechanism.home)
        linear = axis_linear(self.mechanism)
        for coupling in self.mechanism.couplings:
            terms = coupling.coefficients(values, home) if coupling.driver else dict(coupling.rates)
            in_metres = any(linear[axis] for axis in coupling.rates)
            self.rows.append(Row(f"{coupling.name}.rate", "coupling", coupling.name, in_metres))
            self._scalar_rows.append(terms)

    def _add_drives(self) -> None:
        linear = axis_linear(self.mechanism)
        for drive in self.mechanism.drives:
            if drive.name not in self.mechanism.active:
                continue
            guessed = any(linear[axis] for axis in drive.drives)
            in_metres = guessed if drive.linear is None else drive.linear
            nothing = np.zeros(self.mechanism.space.dimension)
            self._add_column(Column(drive.name, drive.name, in_metres), nothing)
            self.rows.append(Row(f"{drive.name}.rate", "drive", drive.name, in_metres))
            self._scalar_rows.append({**drive.drives, drive.name: -1.0})

    def path_columns(self, body: str) -> tuple[list[int], list[int]]:
        """Columns, and their signs, on the way from a body's root to it."""
        if body not in self._path_columns:
            found = [
                (i, sign) for joint, sign in self.reduction.paths[body] for i in self.of_joint.get(joint, ())
            ]
            self._path_columns[body] = ([i for i, _ in found], [sign for _, sign in found])
        return self._path_columns[body]

    def matrices(self) -> tuple[Matrix, Matrix]:
        """J (rows x all columns) and G^T (rows x d), before columns are split by motors."""
        d = self.mechanism.space.dimension
        twists = np.column_stack(self.twists) if self.twists else np.zeros((d, 0))
        jacobian = np.zeros((len(self.rows), len(self.columns)))
        member = np.zeros((len(self.rows), d))
        row = 0
        for block in self._blocks:
            count = len(block.matrix)
            part = slice(row, row + count)
            axes = block.matrix @ twists
            for body, side in block.terms:
                columns, signs = self.path_columns(body)
                jacobian[part, columns] += axes[:, columns] * (side * np.array(signs, dtype=float))
            if block.own is not None:
                columns = self.of_joint[block.own[0]]
                jacobian[part, columns] += axes[:, columns] * block.own[1]
            member[part] = block.carried * block.matrix
            row += count
        for terms in self._scalar_rows:
            for axis, coefficient in terms.items():
                if axis in self.index:
                    jacobian[row, self.index[axis]] = coefficient
            row += 1
        return jacobian, member

    def curvature(self) -> float:
        """Bound K on the second derivatives of the loop equations in scaled units.

        Along a chain of n axes |f''(v, v)| <= (sum |v_i|)^2 r <= n r |v|^2 with r the largest distance
        of its joints from the cut; the member's own motion counts as one more chain.
        """
        length = self.mechanism.length
        longest = max(
            (
                sum(len(self.path_columns(body)[0]) for body, _ in block.terms) + abs(block.carried)
                for block in self._blocks
            ),
            default=0,
        )
        frames = [part_frames(joint, self.poses)[0].position for joint in self.mechanism.joints]
        reach = max((float(np.linalg.norm(point - self.origin)) for point in frames), default=0.0)
        return max(1, longest) * max(1.0, reach / length)

    def motions(self, order: Sequence[int]) -> BodyMotions:
        """How every rigid group of bodies moves, columns in the model's order."""
        names = list(self.reduction.clusters)
        d = self.mechanism.space.dimension
        path = np.zeros((len(names), len(self.columns)))
        for k, name in enumerate(names):
            columns, signs = self.path_columns(name)
            path[k, columns] = signs
        twists = np.column_stack(self.twists) if self.twists else np.zeros((d, 0))
        member = self.mechanism.reference.body if self.mechanism.reference else ""
        shown = [member if member in self.reduction.clusters[n] else n for n in names]
        return BodyMotions(
            names=tuple(shown),
            screws=frozen(twists[:, list(order)]),
            path=frozen(path[:, list(order)]),
            carried=tuple(self.reduction.carried[n] for n in names),
            origin=frozen(np.array(self.origin)),
        )
