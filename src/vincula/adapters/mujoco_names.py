"""Names of the parts of a compiled MuJoCo model; what has no name is called by kind and index."""

from __future__ import annotations

from typing import Any, Final

import mujoco

from vincula.mechanism.parts import GROUND

_KINDS: Final = {
    "body": (mujoco.mjtObj.mjOBJ_BODY, "nbody", "body"),
    "joint": (mujoco.mjtObj.mjOBJ_JOINT, "njnt", "jnt"),
    "site": (mujoco.mjtObj.mjOBJ_SITE, "nsite", "site"),
    "geom": (mujoco.mjtObj.mjOBJ_GEOM, "ngeom", "geom"),
    "actuator": (mujoco.mjtObj.mjOBJ_ACTUATOR, "nu", "actuator"),
    "tendon": (mujoco.mjtObj.mjOBJ_TENDON, "ntendon", "tendon"),
    "equality": (mujoco.mjtObj.mjOBJ_EQUALITY, "neq", ""),
    "key": (mujoco.mjtObj.mjOBJ_KEY, "nkey", "key"),
}


class ModelNames:
    """Names by kind and index, each unique within its kind.

    Attributes:
        bodies: Names of the bodies; the world is `ground`.
        joints: Names of the joints, `jnt<id>` for those without.
        sites: Names of the sites, `site<id>` for those without.
        geoms: Names of the geoms, `geom<id>` for those without.
        actuators: Names of the actuators, `actuator<id>` for those without.
        tendons: Names of the tendons, `tendon<id>` for those without.
        equalities: Names of the equalities, empty for those without.
        keys: Names of the keyframes, `key<id>` for those without.
        renamed: Names of the model that could not be kept, and what stands for them.
    """

    def __init__(self, model: Any) -> None:
        self.renamed: dict[str, str] = {}
        self.bodies = self._bodies(_names(model, "body"))
        self.joints = _names(model, "joint")
        self.sites = _names(model, "site")
        self.geoms = _names(model, "geom")
        self.actuators = _names(model, "actuator")
        self.tendons = _names(model, "tendon")
        self.equalities = _names(model, "equality")
        self.keys = _names(model, "key")

    def _bodies(self, names: list[str]) -> list[str]:
        names[0] = GROUND
        for index, name in enumerate(names[1:], start=1):
            if name == GROUND:
                names[index] = unused(f"body{index}", names)
                self.renamed[name] = names[index]
        return names


def _names(model: Any, kind: str) -> list[str]:
    code, count, prefix = _KINDS[kind]
    given = [mujoco.mj_id2name(model, code, index) or "" for index in range(getattr(model, count))]
    if not prefix:
        return given
    taken = set(given)
    result = []
    for index, name in enumerate(given):
        own = name or unused(f"{prefix}{index}", taken)
        taken.add(own)
        result.append(own)
    return result


def unused(name: str, taken: list[str] | set[str]) -> str:
    """`name`, with underscores after it until it is not among `taken`."""
    while name in taken:
        name += "_"
    return name
