"""MuJoCo + numpy: constraint rows from the engine, kernel by SVD, spectra and axes; a process a core.

The legs are universal joint, slide, and a `connect` to the platform (a soft finger has no equality in
MuJoCo; universal joints keep the legs from spinning, and leave the platform's motions the same).  Positions
are computed in closed form: outside of what is timed when configurations are given, inside when only the
pose is.
"""

from __future__ import annotations

import multiprocessing
import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from peers.cases import HEIGHT, Array, Platform, path_poses, random_poses, rotation, stewart


def _model_text(platform: Platform) -> str:
    legs, welds = [], []
    for k, (low, arm) in enumerate(zip(platform.base, platform.upper, strict=True)):
        place = " ".join(f"{v:.17g}" for v in low)
        there = " ".join(f"{v:.17g}" for v in arm)
        legs.append(
            f"<body name='c{k}' pos='{place}'><joint type='hinge' axis='1 0 0'/>"
            "<joint type='hinge' axis='0 1 0'/><geom size='0.01'/>"
            f"<body name='r{k}'><joint name='p{k}' type='slide' axis='0 0 1'/>"
            "<geom size='0.01'/></body></body>"
        )
        welds.append(f"<connect name='w{k}' body1='platform' body2='r{k}' anchor='{there}'/>")
    return (
        "<mujoco><compiler angle='radian'/><option jacobian='dense'><flag contact='disable'/></option>"
        "<worldbody>"
        f"<body name='platform' pos='0 0 {HEIGHT}'><freejoint/><geom size='0.01'/></body>"
        f"{''.join(legs)}</worldbody><equality>{''.join(welds)}</equality></mujoco>"
    )


@dataclass
class Pipeline:
    """One process's engine and what it needs.

    Attributes:
        platform: The geometry.
    """

    platform: Platform
    _model: Any = field(init=False)
    _data: Any = field(init=False)

    def __post_init__(self) -> None:
        import mujoco

        self._model = mujoco.MjModel.from_xml_string(_model_text(self.platform))
        # A connect takes its anchor on the second body from the drawn pose, where legs have length zero.
        for k in range(len(self.platform.base)):
            self._model.eq_data[k, 3:6] = 0.0
        self._data = mujoco.MjData(self._model)

    def positions(self, poses: Array) -> Array:
        """Positions of all joints in closed form."""
        unit, length = self.platform.legs(poses)
        about_x = np.arctan2(-unit[:, :, 1], unit[:, :, 2])
        about_y = np.arcsin(unit[:, :, 0])
        legs = np.stack([about_x, about_y, length], axis=2).reshape(len(poses), -1)
        return np.concatenate([poses, legs], axis=1)

    def rows(self, positions: Array) -> Array:
        """n x 18 x 24 constraint rows of the engine."""
        import mujoco

        model, data = self._model, self._data
        count = 3 * len(self.platform.base)
        found = np.empty((len(positions), count, model.nv))
        for k, q in enumerate(positions):
            data.qpos[:] = q
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_makeConstraint(model, data)
            found[k] = data.efc_J.reshape(count, model.nv)
        return found

    def analyse(self, positions: Array) -> tuple[Array, ...]:
        """Kinematic and force efficiencies with both sets of axes, all configurations at once."""
        _, _, right = np.linalg.svd(self.rows(positions))
        kernel = right[:, -6:].transpose(0, 2, 1)
        motors = np.arange(8, self._model.nv, 3)
        jacobian = kernel[:, :6] @ np.linalg.inv(kernel[:, motors])
        jacobian[:, 3:] = rotation(positions[:, 3:7]) @ jacobian[:, 3:]  # the engine's are in body axes
        twists, values, rates = np.linalg.svd(jacobian)
        return values**2, values[:, ::-1] ** -2.0, twists, rates


_worker: dict[str, Any] = {}


def _ready(count: int, share: int, shares: int) -> float:
    """Sets up one worker with its share of the configurations; returns its worst difference from LAPACK."""
    from peers.floor import difference

    pipeline = Pipeline(stewart())
    poses = random_poses(count)[share::shares]
    path = path_poses(count)[share::shares]
    _worker.update(pipeline=pipeline, positions=pipeline.positions(poses), path=path)
    sample = poses[:50]
    return difference(pipeline.platform, sample, pipeline.analyse(pipeline.positions(sample))[0])


def _closed(_: int) -> float:
    return float(_worker["pipeline"].analyse(_worker["positions"])[0][-1, 0])


def _posed(_: int) -> float:
    pipeline = _worker["pipeline"]
    return float(pipeline.analyse(pipeline.positions(_worker["path"]))[0][-1, 0])


class Engine:
    """A process a core, each with its share of `count` configurations.

    Raises:
        ImportError: MuJoCo is not there.
    """

    def __init__(self, count: int) -> None:
        import mujoco  # noqa: F401  is it there?

        self.count = count
        context = multiprocessing.get_context("spawn")
        cores = os.cpu_count() or 1
        self._pools = [context.Pool(1) for _ in range(cores)]
        ready = [pool.apply_async(_ready, (count, k, cores)) for k, pool in enumerate(self._pools)]
        self.difference = max(result.get(120) for result in ready)

    def run(self, *, posed: bool = False) -> None:
        """All configurations once: joint positions given, or poses alone."""
        waiting = [pool.apply_async(_posed if posed else _closed, (0,)) for pool in self._pools]
        for result in waiting:
            result.get(300)

    def close(self) -> None:
        """Ends the processes."""
        for pool in self._pools:
            pool.terminate()
            pool.join()
