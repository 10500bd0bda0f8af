"""What following a path gives: configurations, and where, why and of which type it stopped."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from vincula.mechanism.configuration import Configuration
from vincula.mechanism.singularities import Singularity

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

StopKind = Literal["singularity", "limit", "incompatible", "lost"]


@dataclass(frozen=True, slots=True, eq=False)
class PathPoint:
    """One configuration of a path.

    Attributes:
        parameter: Distance travelled by what is held, 0 at the start [rad, or lengths L].
        configuration: The closed configuration.
        residual: Norm of the closure residual [m, angles times L].
        margin: Smallest singular value of the block nearest to singular, scaled units; it vanishes at
            singularities.
    """

    parameter: float
    configuration: Configuration
    residual: float
    margin: float


@dataclass(frozen=True, slots=True, eq=False)
class PathEvent:
    """A singularity or limit on a path.

    Attributes:
        kind: `singularity`, `limit`, `incompatible` (what is held cannot move together that way) or
            `lost` (the corrector did not find the branch again).
        parameter: Where: distance travelled by what is held [rad, or lengths L].
        configuration: The configuration there; at a singularity the singular one.
        singularities: What is singular there, by type.
        axis: The axis that meets its limit.
        limit: Value of that limit [rad, m].
        reason: In words.
        passable: Whether the path goes on beyond it, so that `through` would pass it; a fold, where
            what is held would have to turn back, cannot be passed.
    """

    kind: StopKind
    parameter: float
    configuration: Configuration
    singularities: tuple[Singularity, ...] = ()
    axis: str = ""
    limit: float = float("nan")
    reason: str = ""
    passable: bool = False

    @property
    def joints(self) -> tuple[str, ...]:
        """Joints that take part, largest share first."""
        shares: dict[str, float] = {}
        for singularity in self.singularities:
            for name, share in singularity.joints.items():
                shares[name] = max(share, shares.get(name, 0.0))
        return tuple(sorted(shares, key=lambda name: -shares[name])) or ((self.axis,) if self.axis else ())

    def __str__(self) -> str:
        return self.reason


@dataclass(frozen=True, eq=False)
class Path:
    """A followed path: closed configurations on one assembly branch.

    Attributes:
        mechanism: The mechanism.
        held: Names of what was held along the path.
        points: The configurations at the asked-for values, as far as the path goes; the last one is
            where it stopped if it did.
        length: Length of the whole path asked for [rad, or lengths L].
        stopped: Where and why it stopped; None when it was followed to its end.
        passed: Singularities and limits that were passed because the caller asked for it.
        steps: Predictor-corrector steps that were taken.
    """

    mechanism: Mechanism
    held: tuple[str, ...]
    points: tuple[PathPoint, ...]
    length: float
    stopped: PathEvent | None
    passed: tuple[PathEvent, ...]
    steps: int

    @property
    def complete(self) -> bool:
        """Whether the path was followed to its end."""
        return self.stopped is None

    @property
    def end(self) -> Configuration:
        """The last configuration."""
        return self.points[-1].configuration

    @property
    def residual(self) -> float:
        """Largest closure residual along the path [m, angles times L]."""
        return max(point.residual for point in self.points)

    def __iter__(self) -> Iterator[Configuration]:
        return (point.configuration for point in self.points)

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, index: int) -> Configuration:
        return self.points[index].configuration

    def table(self) -> tuple[tuple[str, ...], list[list[float]]]:
        """Column names and rows: parameter, every joint value, residual, margin."""
        names = ["parameter"]
        for joint, values in self.end.items():
            names += [joint] if len(values) == 1 else [f"{joint}[{k}]" for k in range(len(values))]
        names += ["residual", "margin"]
        rows = [
            [point.parameter, *(float(v) for values in point.configuration.values() for v in values),
             point.residual, point.margin]
            for point in self.points
        ]  # fmt: skip
        return tuple(names), rows

    def frames(self) -> Iterator[dict[str, tuple[list[float], list[list[float]]]]]:
        """For every point the position and rotation matrix of every body, for animations."""
        for configuration in self:
            poses = self.mechanism.body_poses(configuration)
            yield {
                name: ([float(x) for x in pose.position], np.asarray(pose.rotation).tolist())
                for name, pose in poses.items()
            }

    def __str__(self) -> str:
        done = f"{len(self.points)} configurations, closure residual at most {self.residual:.2g} m"
        if self.stopped is None:
            return f"followed to the end: {done}"
        share = 100.0 * self.stopped.parameter / self.length if self.length else 0.0
        return f"stopped after {share:.4g} % of the path: {self.stopped}; {done}"
