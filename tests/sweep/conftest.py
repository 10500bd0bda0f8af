"""A small sweep that is cheap to compute, and how to compare data sets byte by byte."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import vincula as vc
from vincula.sweep.sweep import Sweep

pytest.importorskip("zarr", reason="extra sweep")
pytest.importorskip("xarray", reason="extra sweep")

Files = dict[str, bytes]


def files_of(folder: Path) -> Files:
    """Every file below a folder with its content."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def beside(folder: Path) -> list[str]:
    """Names of everything beside a data set, but the data set itself and its ledger."""
    own = {folder.name, f"{folder.name}.ledger"}
    return sorted(path.name for path in folder.parent.iterdir() if path.name not in own)


def serial_sweep(chunk: int = 16) -> Sweep:
    """A serial arm over a grid: nothing is closed."""
    arm = vc.load("example:serial-2r")
    names = list(arm.home)
    over = {names[0]: np.linspace(-1.0, 1.0, 9), names[1]: np.linspace(0.3, 2.0, 11)}
    return Sweep(arm, over, ["kinematic.efficiencies", "kinematic.smallest", "counts"], chunk=chunk)


def five_bar_sweep(chunk: int = 12) -> Sweep:
    """A five-bar over motor values, some out of reach: loops are closed."""
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    over = {"o1": np.radians(np.linspace(-8.0, 4.0, 6)), "o5": np.radians(np.linspace(-8.0, 4.0, 9))}
    return Sweep(linkage, over, ["kinematic.efficiencies", "closure.residual", "configuration"], chunk=chunk)


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Data set of an undisturbed run of `serial` or `five-bar`, computed once."""
    folder = tmp_path_factory.mktemp("undisturbed")

    def computed(name: str) -> Path:
        target = folder / f"{name}.zarr"
        if not target.exists():
            sweep = serial_sweep() if name == "serial" else five_bar_sweep()
            sweep.run(target, threads=1)
        return target

    return computed
