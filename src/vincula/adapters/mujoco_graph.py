"""From a compiled MuJoCo model to a mechanism: shared by the file reader and the live adapter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from vincula.adapters.mujoco_constraints import Constraints
from vincula.adapters.mujoco_joints import Tree, joint_type_of, joint_values, site_frames
from vincula.adapters.mujoco_motors import Motors
from vincula.adapters.mujoco_names import ModelNames
from vincula.errors import listing
from vincula.files.report import LoadReport
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Precision
from vincula.spatial.poses import Pose
from vincula.spatial.space import SPATIAL


def mechanism_of(
    model: Any,
    names: ModelNames,
    report: LoadReport,
    *,
    name: str,
    precision: Precision | None = None,
    active_equalities: Sequence[bool] | None = None,
    mocap: Mapping[int, Pose] | None = None,
) -> Mechanism:
    """The mechanism graph of a compiled model, at its home configuration `qpos0`.

    Args:
        model: A `mujoco.MjModel`.
        names: Names of its parts.
        report: Where everything that becomes part of the graph is recorded.
        name: Name of the mechanism.
        precision: Typed digits of the file; numbers of a live model are exact.
        active_equalities: For every equality, whether it is active; by default as the model says.
        mocap: Poses of mocap bodies by index; by default as drawn.

    Raises:
        UnsupportedFeatureError: An active equality that cannot be represented.
        ModelError: The model is no mechanism; see `Mechanism`.
    """
    if active_equalities is None:
        active_equalities = [bool(flag) for flag in model.eq_active0]
    tree = Tree(model, names, mocap)
    constraints = Constraints(model, names, active_equalities, report)
    motors = Motors(model, names, report)
    frames = site_frames(model, names)
    _record(model, names, tree, report)
    _record_tendons(model, names, constraints.tendons | motors.tendons, report)
    return Mechanism(
        space=SPATIAL,
        bodies=tuple(tree.bodies),
        joints=(*tree.joints, *constraints.closures),
        couplings=tuple(constraints.couplings),
        drives=tuple(motors.drives),
        frames=tuple(frames),
        active=motors.active,
        name=name,
        precision=precision or Precision(),
        motors=dict(motors.axis_of),
        keyframes=_keyframes(model, names),
    )


def configuration_of(model: Any, names: ModelNames, qpos: Any) -> dict[str, tuple[float, ...]]:
    """Values by joint of a `qpos` vector."""
    return {joint: joint_values(model, index, qpos) for index, joint in enumerate(names.joints)}


def _keyframes(model: Any, names: ModelNames) -> dict[str, dict[str, tuple[float, ...]]]:
    return {
        key: configuration_of(model, names, model.key_qpos[index]) for index, key in enumerate(names.keys)
    }


def _record(model: Any, names: ModelNames, tree: Tree, report: LoadReport) -> None:
    for old, new in names.renamed.items():
        report.repaired("body", old, f"called {new} here, because {old!r} is the fixed body")
    for index, body in enumerate(names.bodies[1:], start=1):
        if body not in names.renamed.values():
            fixed = "" if model.body_jntnum[index] else "fixed to its parent"
            report.used("body", body, "mocap body, fixed to the ground" if body in tree.mocap else fixed)
    for index, joint in enumerate(names.joints):
        report.used("joint", joint, joint_type_of(model, index))
    for site in names.sites:
        report.used("site", site, "named frame")
    for key in names.keys:
        report.used("keyframe", key, f"configuration key:{key}")
    if tree.mocap:
        report.note(f"mocap bodies are fixed to the ground where they stand: {listing(tree.mocap)}")
    springs = [joint for index, joint in enumerate(names.joints) if model.jnt_stiffness[index] > 0]
    if springs:
        report.note(
            f"springs are not modelled: {listing(springs)} can move freely; hold a joint still by locking it"
        )


def _record_tendons(model: Any, names: ModelNames, used: set[int], report: LoadReport) -> None:
    for index, tendon in enumerate(names.tendons):
        if index in used:
            report.used("tendon", tendon, "its coefficients are those of a motor or coupling")
        else:
            report.ignored("tendon", tendon, "no motor or coupling uses it; its limits are not modelled")
    stretched = [tendon for index, tendon in enumerate(names.tendons) if model.tendon_stiffness[index] > 0]
    if stretched:
        report.note(f"springs of tendons are not modelled: {listing(stretched)}")
