"""The C++ floor (floor.cpp), built and called; the same numbers by numpy check it and every other peer."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np

from peers.cases import Array, Platform, rotation

SOURCE = Path(__file__).resolve().parent.parent / "floor.cpp"


class Floor:
    """The compiled floor for one platform of six legs.

    Args:
        platform: Its geometry.
        folder: Where the library is built.
    """

    def __init__(self, platform: Platform, folder: Path) -> None:
        library = _built(folder)
        self._call = library.stewart_floor
        self._call.restype = None
        self._geometry = np.ascontiguousarray(np.concatenate([platform.base, platform.upper]))

    def run(self, poses: Array, out: Array, threads: int = 0) -> Array:
        """Everything of every pose: n x 84, or n x 156 with the axes of forces written too."""
        pointer = ctypes.POINTER(ctypes.c_double)
        self._call(
            poses.ctypes.data_as(pointer),
            ctypes.c_long(len(poses)),
            self._geometry.ctypes.data_as(pointer),
            out.ctypes.data_as(pointer),
            out.shape[1],
            threads or os.cpu_count() or 1,
        )
        return out


def _built(folder: Path) -> ctypes.CDLL:
    """The library, compiled for this processor.

    Raises:
        RuntimeError: There is no g++, or it failed.
    """
    compiler = shutil.which("g++")
    if compiler is None:
        raise RuntimeError("no g++ here")
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / "floor.so"
    flags = ["-O3", "-march=native", "-ffp-contract=fast", "-std=c++17", "-shared", "-fPIC", "-pthread"]
    built = subprocess.run(
        [compiler, *flags, str(SOURCE), "-o", str(target)], capture_output=True, text=True, check=False
    )
    if built.returncode:
        raise RuntimeError(f"g++ failed: {built.stderr.strip().splitlines()[0]}")
    return ctypes.CDLL(str(target))


def inverse_jacobians(platform: Platform, poses: Array) -> Array:
    """n x legs x 6: motor rates of a twist (linear, angular) at the reference point in ground axes."""
    unit, _ = platform.legs(poses)
    arms = np.einsum("nij,kj->nki", rotation(poses[:, 3:]), platform.upper)
    return np.concatenate([unit, np.cross(arms, unit)], axis=2)


def efficiencies(platform: Platform, poses: Array) -> Array:
    """n x 6 kinematic efficiencies, descending, by LAPACK."""
    values = np.linalg.svd(inverse_jacobians(platform, poses), compute_uv=False)
    return np.asarray(values[:, ::-1] ** -2.0)


def difference(platform: Platform, poses: Array, found: Array) -> float:
    """Largest relative difference of efficiencies from LAPACK's."""
    return float(np.abs(found / efficiencies(platform, poses) - 1.0).max())
