"""Couplings, locks, motors and drives of a mechanism as MJCF equalities, tendons and actuators."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import quoteattr

from vincula.files.written import free_name, number, numbers
from vincula.files.written_couplings import at_home
from vincula.mechanism.parts import Coupling

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

_DEGREE: Final = 4
"""MJCF has polynomials up to this degree."""


@dataclass
class Couples:
    """Couplings in MJCF.

    Attributes:
        equalities: Equalities.
        tendons: The fixed tendons that they use.
        lost: Couplings that MJCF cannot hold, one sentence each.
    """

    equalities: list[str] = field(default_factory=list)
    tendons: list[str] = field(default_factory=list)
    lost: list[str] = field(default_factory=list)


def couplings(mechanism: Mechanism) -> Couples:
    """Couplings between two axes are joint equalities, all others tendon equalities.

    MuJoCo measures both sides from their values at `qpos0`, which is the home configuration.
    """
    found = Couples()
    taken = {drive.name for drive in mechanism.drives}
    for coupling in mechanism.couplings:
        rates, driver, polynomial = at_home(coupling, mechanism)
        if len(polynomial) > _DEGREE + 1:
            found.lost.append(f"coupling {coupling.name!r}: MJCF has polynomials up to degree {_DEGREE} only")
        elif len(rates) == 1 and len(driver) <= 1:
            found.equalities.append(_of_joints(coupling, rates, driver, polynomial))
        else:
            sides = []
            for side, terms in (("rates", rates), ("driver", driver)):
                if terms:
                    name = free_name(f"{coupling.name}.{side}", taken)
                    sides.append(name)
                    found.tendons.append(tendon(name, terms))
            names = " ".join(f"tendon{k}={quoteattr(name)}" for k, name in enumerate(sides, start=1))
            found.equalities.append(
                f'<tendon name={quoteattr(coupling.name)} {names} polycoef="{_five(polynomial)}"/>'
            )
    return found


def _of_joints(
    coupling: Coupling, rates: Mapping[str, float], driver: Mapping[str, float], polynomial: list[float]
) -> str:
    (follower, scale), (leader, inner) = next(iter(rates.items())), next(iter(driver.items()), ("", 1.0))
    scaled = [a * inner**power / scale for power, a in enumerate(polynomial)]
    second = f" joint2={quoteattr(leader)}" if leader else ""
    joints = f"joint1={quoteattr(follower)}{second}"
    return f'<joint name={quoteattr(coupling.name)} {joints} polycoef="{_five(scaled)}"/>'


def _five(polynomial: list[float]) -> str:
    return numbers([*polynomial, *[0.0] * (_DEGREE + 1 - len(polynomial))])


def tendon(name: str, terms: Mapping[str, float]) -> str:
    """A fixed tendon whose length is a sum of joint values."""
    joints = "".join(f'<joint joint={quoteattr(axis)} coef="{number(c)}"/>' for axis, c in terms.items())
    return f"<fixed name={quoteattr(name)}>{joints}</fixed>"


def locks(mechanism: Mechanism) -> list[str]:
    """An equality for every locked axis, which holds it at home."""
    taken = {coupling.name for coupling in mechanism.couplings}
    return [
        f"<joint name={quoteattr(free_name(f'lock:{axis}', taken))} joint1={quoteattr(axis)}"
        f' polycoef="{_five([])}"/>'
        for axis in mechanism.lock
    ]


def actuators(mechanism: Mechanism) -> tuple[list[str], list[str]]:
    """Tendons of the drives, and the motors, in the order of the active axes."""
    drives = {drive.name: drive for drive in mechanism.drives}
    called = {axis: motor for motor, axis in reversed(list(mechanism.motors.items()))}
    tendons, motors = [], []
    taken: set[str] = set()
    for axis in mechanism.active:
        name = quoteattr(free_name(called.get(axis, axis), taken))
        if axis in drives:
            tendons.append(tendon(axis, drives[axis].drives))
            motors.append(f"<motor name={name} tendon={quoteattr(axis)}/>")
        else:
            motors.append(f"<motor name={name} joint={quoteattr(axis)}/>")
    return tendons, motors
