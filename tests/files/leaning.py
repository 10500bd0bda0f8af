"""Four-bars with links drawn at random angles and typed with few digits: planar, or with axes in a point.

No single number means another one, and yet all axes are parallel, or meet, but for rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from vincula.arrays import Vector

BODIES = ("base", "crank", "coupler", "rocker")
JOINTS = {
    "o1": ("base", "crank"),
    "o2": ("crank", "coupler"),
    "o4": ("base", "rocker"),
    "o3": ("coupler", "rocker"),
}
PLANAR = {"o1": (0, 0, 0), "o2": (0, 1, 0), "o3": (2, 2, 0), "o4": (3, 0, 0)}
SPHERICAL = {"o1": (0, 0, 1.0), "o2": (0.65, 0, 1.04), "o3": (0.96, 1.12, 0.8), "o4": (0, 1.52, 1.14)}


class Leaning:
    """One four-bar.

    Args:
        digits: Digits after the point of every number.
        seed: Draws the turns of the links.
        spherical: Whether the axes meet in a point instead of being parallel.
    """

    def __init__(self, digits: int, seed: int, *, spherical: bool) -> None:
        chance = np.random.default_rng(seed)
        turn, base = Rotation.from_rotvec(chance.normal(size=3)), chance.normal(size=3)
        drawn = {name: np.array(at, float) for name, at in (SPHERICAL if spherical else PLANAR).items()}
        axes = {name: at / np.linalg.norm(at) if spherical else np.eye(3)[2] for name, at in drawn.items()}
        self._digits = digits
        self._points = {name: turn.apply(at) + base for name, at in drawn.items()}
        self._axes = {name: turn.apply(axis) for name, axis in axes.items()}
        at = {"crank": "o1", "coupler": "o2", "rocker": "o4"}
        self._places = {"base": (Rotation.identity(), np.zeros(3))} | {
            body: (Rotation.from_rotvec(chance.normal(size=3)), self._points[joint])
            for body, joint in at.items()
        }

    def _typed(self, values: Sequence[float] | Vector) -> str:
        return " ".join(f"{value:.{self._digits}f}" for value in values)

    def urdf(self) -> str:
        """A tree with a loop of URDF+, in general open as typed."""
        lines = [f'<link name="{body}"/>' for body in BODIES]
        for name, (first, second) in list(JOINTS.items())[:3]:
            (turn, point), (inner, end) = self._places[first], self._places[second]
            place = self._origin(turn.inv().apply(end - point), turn.inv() * inner)
            axis = self._typed(inner.inv().apply(self._axes[name]))
            lines.append(
                f'<joint name="{name}" type="continuous"><parent link="{first}"/><child link="{second}"/>'
                f'{place}<axis xyz="{axis}"/></joint>'
            )
        seat = Rotation.align_vectors(self._axes["o3"], [0, 0, 1])[0]
        lines.append('<loop name="o3" type="revolute">')
        for tag, body in zip(("predecessor", "successor"), JOINTS["o3"], strict=True):
            turn, point = self._places[body]
            place = self._origin(turn.inv().apply(self._points["o3"] - point), turn.inv() * seat)
            lines.append(f'<{tag} link="{body}">{place}</{tag}>')
        return "\n".join(['<robot name="leaning">', *lines, '<axis xyz="0 0 1"/></loop></robot>'])

    def _origin(self, position: Vector, turn: Rotation) -> str:
        return f'<origin xyz="{self._typed(position)}" rpy="{self._typed(turn.as_euler("xyz"))}"/>'

    def sdf(self) -> str:
        """A graph, closed as typed: each joint is placed once."""
        lines = []
        for body in BODIES[1:]:
            turn, point = self._places[body]
            place = f"{self._typed(point)} {self._typed(turn.as_euler('xyz'))}"
            lines.append(f'<link name="{body}"><pose>{place}</pose></link>')
        for name, (first, second) in JOINTS.items():
            turn, point = self._places[second]
            axis = self._typed(turn.inv().apply(self._axes[name]))
            lines.append(
                f'<joint name="{name}" type="revolute">'
                f"<pose>{self._typed(turn.inv().apply(self._points[name] - point))} 0 0 0</pose>"
                f"<parent>{first.replace('base', 'world')}</parent><child>{second}</child>"
                f"<axis><xyz>{axis}</xyz></axis></joint>"
            )
        return "\n".join(['<sdf version="1.9"><model name="leaning">', *lines, "</model></sdf>"])


TEXTS: dict[str, Callable[[Leaning], str]] = {"robot.urdf": Leaning.urdf, "model.sdf": Leaning.sdf}
"""How a four-bar is written, by the name of the file."""
