"""Equalities of a compiled MuJoCo model as loop joints and couplings of the mechanism graph."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

import mujoco

from vincula.adapters.mujoco_joints import joint_values
from vincula.adapters.mujoco_names import ModelNames, unused
from vincula.errors import UnsupportedFeatureError
from vincula.files.report import LoadReport
from vincula.mechanism.parts import Coupling, Joint
from vincula.spatial.poses import Pose

_CONNECT: Final = int(mujoco.mjtEq.mjEQ_CONNECT)
_WELD: Final = int(mujoco.mjtEq.mjEQ_WELD)
_JOINT: Final = int(mujoco.mjtEq.mjEQ_JOINT)
_TENDON: Final = int(mujoco.mjtEq.mjEQ_TENDON)
_SITE: Final = int(mujoco.mjtObj.mjOBJ_SITE)

_CLOSED_BY: Final = {
    "connect": "loop closed by a ball: three rows",
    "weld": "loop closed rigidly: six rows",
}


class Constraints:
    """Loop joints and couplings of the active equalities.

    Args:
        model: The compiled model.
        names: Names of its parts.
        active: For every equality, whether it is active.
        report: Where every equality is recorded.

    Attributes:
        closures: Loop joints, known by their two frames.
        couplings: Couplings between joint axes.
        tendons: Indices of the tendons that couplings use.

    Raises:
        UnsupportedFeatureError: An active equality that is neither connect, weld, joint, nor tendon
            on fixed tendons.
    """

    def __init__(self, model: Any, names: ModelNames, active: Sequence[bool], report: LoadReport) -> None:
        self._model, self._names = model, names
        self._joint_names, self._coupling_names = set(names.joints), set[str]()
        self.closures: list[Joint] = []
        self.couplings: list[Coupling] = []
        self.tendons: set[int] = set()
        disabled = bool(int(model.opt.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_EQUALITY))
        readers: dict[int, Callable[[int], None]] = {
            _CONNECT: self._connect,
            _WELD: self._weld,
            _JOINT: self._joint,
            _TENDON: self._tendon,
        }
        for index in range(model.neq):
            kind = equality_kind(model, index)
            if disabled or not active[index]:
                why = "equalities are disabled in the file" if disabled else "it is inactive in the file"
                report.ignored("equality", f"{kind} {self._label(index)}", why)
                continue
            reader = readers.get(int(model.eq_type[index]))
            if reader is None:
                raise UnsupportedFeatureError(
                    f"equality {kind} {self._label(index)} is active; this kind of loop is not supported, "
                    "only connect, weld, joint, and tendon on fixed tendons are"
                )
            reader(index)
            coupled = f"couples {self._label(index)}"
            report.used("equality", f"{kind} {self._label(index)}", _CLOSED_BY.get(kind, coupled))

    def _label(self, index: int) -> str:
        """The equality's name, or the names of what it connects."""
        name = self._names.equalities[index]
        if name:
            return name
        kind = int(self._model.eq_type[index])
        objects = [int(self._model.eq_obj1id[index]), int(self._model.eq_obj2id[index])]
        if kind in (_CONNECT, _WELD):
            at_sites = int(self._model.eq_objtype[index]) == _SITE
            table = self._names.sites if at_sites else self._names.bodies
        elif kind == _JOINT:
            table = self._names.joints
        elif kind == _TENDON:
            table = self._names.tendons
        else:
            return str(index)
        return "-".join(table[i] for i in objects if i >= 0)

    def _loop_name(self, index: int) -> str:
        """A joint name for a loop: the equality's own, else `connect:body1-body2`."""
        own = self._names.equalities[index] or f"{equality_kind(self._model, index)}:{self._label(index)}"
        name = unused(own, self._joint_names)
        self._joint_names.add(name)
        return name

    def _connect(self, index: int) -> None:
        self._close(index, "spherical")

    def _weld(self, index: int) -> None:
        """Six rows; three where the file scales the rotations of the weld by zero."""
        self._close(index, "spherical" if float(self._model.eq_data[index][10]) == 0.0 else "fixed")

    def _close(self, index: int, kind: str) -> None:
        model, names = self._model, self._names
        one, two = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
        if int(model.eq_objtype[index]) == _SITE:
            on_first, on_second = (
                Pose.from_quaternion_wxyz(model.site_quat[site], model.site_pos[site]) for site in (one, two)
            )
            one, two = int(model.site_bodyid[one]), int(model.site_bodyid[two])
        else:
            on_first, on_second = self._compiled_anchors(index)
        self.closures.append(
            Joint(
                self._loop_name(index),
                kind,
                names.bodies[one],
                names.bodies[two],
                on_first,
                on_second,
                closure=True,
                cut="contact" if kind == "spherical" else None,
            )
        )

    def _compiled_anchors(self, index: int) -> tuple[Pose, Pose]:
        """The frames on both bodies that MuJoCo closes at `qpos0`, or where `relpose` puts them."""
        data = self._model.eq_data[index]
        if int(self._model.eq_type[index]) == _CONNECT:
            return Pose.at(data[0:3]), Pose.at(data[3:6])
        return Pose.from_quaternion_wxyz(data[6:10], data[3:6]), Pose.at(data[0:3])

    def _joint(self, index: int) -> None:
        one, two = int(self._model.eq_obj1id[index]), int(self._model.eq_obj2id[index])
        self._couple(index, {one: 1.0}, {two: 1.0} if two >= 0 else {})

    def _tendon(self, index: int) -> None:
        sides: list[dict[int, float]] = []
        for tendon in (int(self._model.eq_obj1id[index]), int(self._model.eq_obj2id[index])):
            terms = fixed_tendon(self._model, tendon) if tendon >= 0 else {}
            if terms is None:
                raise UnsupportedFeatureError(
                    f"equality tendon {self._label(index)}: tendon {self._names.tendons[tendon]!r} runs "
                    "through space, so its length is no sum of joint values; supported are fixed tendons"
                )
            if tendon >= 0:
                self.tendons.add(tendon)
            sides.append(terms)
        self._couple(index, sides[0], sides[1])

    def _couple(self, index: int, rates: dict[int, float], driver: dict[int, float]) -> None:
        """MuJoCo measures both sides from their values at `qpos0`."""
        model, names = self._model, self._names
        home = {names.joints[j]: joint_values(model, j, model.qpos0)[0] for j in (*rates, *driver)}
        polynomial = [float(c) for c in model.eq_data[index][:5]]
        name = self._names.equalities[index] or f"coupling:{self._label(index)}"
        self._coupling_names.add(name := unused(name, self._coupling_names))
        self.couplings.append(
            Coupling(
                name,
                rates={names.joints[j]: c for j, c in rates.items()},
                driver={names.joints[j]: c for j, c in driver.items()},
                polynomial=tuple(polynomial) if driver else (polynomial[0],),
                references=home,
            )
        )


def equality_kind(model: Any, index: int) -> str:
    """The word MJCF has for the kind of an equality: connect, weld, joint, tendon ..."""
    return str(mujoco.mjtEq(int(model.eq_type[index])).name).removeprefix("mjEQ_").lower()


def fixed_tendon(model: Any, tendon: int) -> dict[int, float] | None:
    """Coefficient by joint of a fixed tendon; None for one that runs through space."""
    terms: dict[int, float] = {}
    start = int(model.tendon_adr[tendon])
    for wrap in range(start, start + int(model.tendon_num[tendon])):
        if int(model.wrap_type[wrap]) != int(mujoco.mjtWrap.mjWRAP_JOINT):
            return None
        joint = int(model.wrap_objid[wrap])
        terms[joint] = terms.get(joint, 0.0) + float(model.wrap_prm[wrap])
    return {joint: c for joint, c in terms.items() if c != 0.0}
