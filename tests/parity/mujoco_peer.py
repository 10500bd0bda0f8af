"""MuJoCo as an independent peer: closed configurations, body poses and motions from its own engine."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from scipy.linalg import null_space

from vincula.arrays import Matrix, Vector
from vincula.files.mjcf import load_mjcf
from vincula.files.source import decode
from vincula.mechanism.mechanism import Mechanism


@dataclass
class Peer:
    """One model, read by MuJoCo alone and by us.

    Attributes:
        model: What MuJoCo compiles from the file.
        data: Its state.
        mechanism: What we read from the same file.
        joints: Names of the joints in MuJoCo's order.
        bodies: Names of the bodies in MuJoCo's order.
    """

    model: Any
    data: Any
    mechanism: Mechanism
    joints: list[str]
    bodies: list[str]

    @staticmethod
    def of(source: Path | str) -> Peer:
        """The peer of a file, or of an MJCF text."""
        if isinstance(source, Path):
            model, read = mujoco.MjModel.from_xml_path(str(source)), load_mjcf(source)
        else:
            model, read = (
                mujoco.MjModel.from_xml_string(source),
                load_mjcf(decode(source.encode(), "text.xml")),
            )
        flags = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
        model.opt.disableflags |= flags | mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        joints = [model.joint(i).name or f"jnt{i}" for i in range(model.njnt)]
        bodies = ["ground", *(model.body(i).name or f"body{i}" for i in range(1, model.nbody))]
        return Peer(model, mujoco.MjData(model), read[0], joints, bodies)

    def move_to(self, qpos: Vector) -> None:
        """Put the engine at a configuration."""
        self.data.qpos[:] = qpos
        mujoco.mj_forward(self.model, self.data)

    def values(self) -> dict[str, Vector]:
        """The engine's configuration by joint name."""
        starts = [*(int(a) for a in self.model.jnt_qposadr), self.model.nq]
        return {name: self.data.qpos[starts[i] : starts[i + 1]].copy() for i, name in enumerate(self.joints)}

    def rows(self) -> tuple[Matrix, Vector]:
        """The engine's equality rows and their residuals."""
        d = self.data
        chosen = d.efc_type[: d.nefc] == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        return np.array(d.efc_J).reshape(d.nefc, self.model.nv)[chosen], np.array(d.efc_pos[: d.nefc])[chosen]

    def scatter(self, rng: np.random.Generator, size: float) -> None:
        """A configuration near `qpos0`, whether its loops are closed or not."""
        qpos = self.model.qpos0.copy()
        mujoco.mj_integratePos(self.model, qpos, rng.normal(size=self.model.nv) * size, 1.0)
        self.move_to(qpos)

    def close(self) -> None:
        """Newton's method on the engine's own equality rows."""
        for _ in range(50):
            jacobian, residual = self.rows()
            if np.abs(residual).max(initial=0.0) < 1e-14:
                return
            step = -np.linalg.lstsq(jacobian, residual, rcond=1e-9)[0]
            qpos = self.data.qpos.copy()
            mujoco.mj_integratePos(self.model, qpos, step, 1.0)
            self.move_to(qpos)
        residual = self.rows()[1]
        assert np.abs(residual).max(initial=0.0) < 1e-12, "the peer did not close"

    def kernel(self, body: str, point: Vector) -> Matrix:
        """Basis of all (joint rates, twist of `body` at `point`), rates in the engine's order."""
        jacobian, _ = self.rows()
        n = self.model.nv
        rates = null_space(jacobian, rcond=1e-9) if len(jacobian) else np.eye(n)
        linear, angular = np.zeros((3, n)), np.zeros((3, n))
        mujoco.mj_jac(self.model, self.data, linear, angular, point, self.bodies.index(body))
        return np.linalg.qr(np.vstack([rates, linear @ rates, angular @ rates]))[0]


def our_kernel(mechanism: Mechanism, values: dict[str, Vector], body: str, joints: list[str]) -> Matrix:
    """The same from our linear model: the kernel of [J -G^T], joint rates in the engine's order."""
    free = [j.name for j in mechanism.joints if j.type == "free"]
    model = mechanism.with_active(free).with_reference(body).linearize(values)
    rows = np.hstack([model.jacobian_active, model.jacobian_passive, -model.grasp.T])
    kernel = null_space(rows, rcond=1e-9)
    names = [column.name for column in model.columns]
    axes = [a for j in joints for a in mechanism.type_of(mechanism.joint[j]).axis_names(j)]
    assert sorted(names) == sorted(axes)
    order = [names.index(axis) for axis in axes]
    return kernel[[*order, *range(len(names), len(names) + 6)]]


def gap(one: Matrix, other: Matrix) -> float:
    """Distance of two subspaces given by orthonormal bases: largest difference of their projectors."""
    assert one.shape == other.shape
    return float(np.abs(one @ one.T - other @ other.T).max(initial=0.0))
