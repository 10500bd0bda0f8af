"""Actuators of a compiled MuJoCo model as motors of the mechanism graph."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import mujoco

from vincula.adapters.mujoco_constraints import fixed_tendon
from vincula.adapters.mujoco_joints import joint_type_of
from vincula.adapters.mujoco_names import ModelNames, unused
from vincula.files.report import LoadReport
from vincula.mechanism.joint_types import joint_type
from vincula.mechanism.parts import Drive
from vincula.spatial.space import SPATIAL

_JOINT: Final = int(mujoco.mjtTrn.mjTRN_JOINT)
_JOINT_IN_PARENT: Final = int(mujoco.mjtTrn.mjTRN_JOINTINPARENT)
_TENDON: Final = int(mujoco.mjtTrn.mjTRN_TENDON)
_LAST_GROUP: Final = 30


class Motors:
    """Motors of a model: an axis or a drive for every actuator that is one.

    Args:
        model: The compiled model.
        names: Names of its parts.
        report: Where every actuator is recorded.

    Attributes:
        axis_of: Axis or drive by actuator name.
        drives: Motors that drive a combination of axes.
    """

    def __init__(self, model: Any, names: ModelNames, report: LoadReport) -> None:
        self._model, self._names, self._report = model, names, report
        self._axes = {
            axis
            for joint, name in enumerate(names.joints)
            for axis in joint_type(joint_type_of(model, joint), SPATIAL).axis_names(name)
        }
        self._drive_of_tendon: dict[int, str] = {}
        self.axis_of: dict[str, str] = {}
        self.drives: list[Drive] = []
        for index in range(model.nu):
            self._add(index)

    @property
    def active(self) -> tuple[str, ...]:
        """The active axes and drives, each once, in the order of the actuators."""
        return tuple(dict.fromkeys(self.axis_of.values()))

    @property
    def tendons(self) -> set[int]:
        """Indices of the tendons that motors pull."""
        return set(self._drive_of_tendon)

    def _add(self, index: int) -> None:
        name, kind = self._names.actuators[index], int(self._model.actuator_trntype[index])
        target = int(self._model.actuator_trnid[index][0])
        group = int(self._model.actuator_group[index])
        if 0 <= group <= _LAST_GROUP and int(self._model.opt.disableactuator) >> group & 1:
            self._report.ignored("motor", name, f"actuator group {group} is disabled in the file")
        elif kind in (_JOINT, _JOINT_IN_PARENT):
            self._on_joint(index, name, target, in_parent=kind == _JOINT_IN_PARENT)
        elif kind == _TENDON:
            self._on_tendon(name, target)
        else:
            word = str(mujoco.mjtTrn(kind).name).removeprefix("mjTRN_").lower()
            self._report.ignored("motor", name, f"a {word} transmission drives no joint axis: it is no motor")

    def _on_joint(self, index: int, name: str, joint: int, *, in_parent: bool) -> None:
        kind = joint_type(joint_type_of(self._model, joint), SPATIAL)
        axes = kind.axis_names(self._names.joints[joint])
        gear = [float(g) for g in self._model.actuator_gear[index][: len(axes)]]
        if len(axes) == 1:
            self._use(name, axes[0], "" if gear[0] == 1.0 else f"; its gear {gear[0]:g} is not used")
            return
        terms = {axis: g for axis, g in zip(axes, gear, strict=True) if g != 0.0}
        turns = any(axis.rsplit(".", 1)[1] in ("x", "y", "z", "wx", "wy", "wz") for axis in terms)
        if in_parent and turns:
            reason = f"it turns {self._names.joints[joint]} about an axis of the parent: no joint axis"
            self._report.ignored("motor", name, reason)
        elif not terms:
            self._report.ignored("motor", name, "its gear is zero: it drives nothing")
        elif len(terms) == 1:
            self._use(name, next(iter(terms)), "")
        else:
            size = sum(g * g for g in terms.values()) ** 0.5
            self._drive(name, {axis: g / size for axis, g in terms.items()}, "along its gear direction")

    def _on_tendon(self, name: str, tendon: int) -> None:
        if tendon in self._drive_of_tendon:
            self._use(name, self._drive_of_tendon[tendon], "")
            return
        terms = fixed_tendon(self._model, tendon)
        if not terms:
            reason = "a tendon through space is no motor" if terms is None else "its tendon moves no joint"
            self._report.ignored("motor", name, reason)
            return
        axes = {self._names.joints[joint]: c for joint, c in terms.items()}
        how = f"through tendon {self._names.tendons[tendon]}"
        self._drive_of_tendon[tendon] = self._drive(name, axes, how)

    def _drive(self, name: str, terms: Mapping[str, float], how: str) -> str:
        drive = unused(name, self._axes | {other.name for other in self.drives})
        self.drives.append(Drive(drive, dict(terms)))
        self.axis_of[name] = drive
        detail = " + ".join(f"{c:g} {axis}" for axis, c in terms.items())
        self._report.used("motor", name, f"drives {detail} {how}")
        return drive

    def _use(self, name: str, axis: str, remark: str) -> None:
        if axis in self.axis_of.values():
            remark += "; one motor with another actuator"
        self.axis_of[name] = axis
        self._report.used("motor", name, f"drives {axis}{remark}")
