"""Couplings as robot files hold them: one axis follows another, or a polynomial of sums.

Values are displacements from the home configuration, where a file is drawn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from numpy.polynomial import Polynomial

from vincula.mechanism.parts import Coupling
from vincula.mechanism.residuals import axis_values

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


@dataclass(frozen=True, slots=True)
class Following:
    """follower = factor x leader + offset, in displacements from home.

    Attributes:
        coupling: Name of the coupling.
        follower: Axis that follows.
        leader: Axis that is followed.
        factor: Their ratio.
        offset: Value of the follower where the leader is at home [rad or m].
    """

    coupling: str
    follower: str
    leader: str
    factor: float
    offset: float


def linear_rates(coupling: Coupling) -> dict[str, float] | None:
    """Coefficient by axis of a linear coupling; None for any other."""
    if any(coupling.polynomial[2:]) or (coupling.driver and len(coupling.polynomial) < 2):
        return None
    slope = coupling.polynomial[1] if coupling.driver else 0.0
    rates = dict(coupling.rates)
    for axis, c in coupling.driver.items():
        rates[axis] = rates.get(axis, 0.0) - slope * c
    return {axis: float(c) for axis, c in rates.items() if c != 0.0}


def home_residual(coupling: Coupling, mechanism: Mechanism) -> float:
    """How far the home configuration is from satisfying a coupling [rad or m]."""
    home = axis_values(mechanism, mechanism.home)
    return coupling.residual(home, home)


def followings(mechanism: Mechanism) -> tuple[list[Following], list[Coupling]]:
    """Couplings as followers, each axis following one other and none itself; and those that are not."""
    found: dict[str, Following] = {}
    left: list[Coupling] = []

    def leads_back(leader: str, follower: str) -> bool:
        while leader in found and leader != follower:
            leader = found[leader].leader
        return leader == follower

    for coupling in mechanism.couplings:
        rates = linear_rates(coupling)
        pairs = [] if rates is None or len(rates) != 2 else [tuple(rates), tuple(reversed(rates))]
        for follower, leader in pairs:
            if rates is not None and follower not in found and not leads_back(leader, follower):
                offset = -home_residual(coupling, mechanism) / rates[follower]
                factor = -rates[leader] / rates[follower]
                found[follower] = Following(coupling.name, follower, leader, factor, offset)
                break
        else:
            left.append(coupling)
    return list(found.values()), left


def at_home(
    coupling: Coupling, mechanism: Mechanism
) -> tuple[Mapping[str, float], Mapping[str, float], list[float]]:
    """Rates, driver and polynomial of a coupling in displacements from home.

    sum rates x d = p(sum driver x d), where d are displacements.
    """
    home = axis_values(mechanism, mechanism.home)

    def moved(terms: Mapping[str, float]) -> float:
        return sum(c * (home[a] - coupling.references.get(a, home[a])) for a, c in terms.items())

    shifted = Polynomial(list(coupling.polynomial) or [0.0])(Polynomial([moved(coupling.driver), 1.0]))
    coefficients = [float(c) for c in shifted.coef] if isinstance(shifted, Polynomial) else [float(shifted)]
    coefficients[0] -= moved(coupling.rates)
    return coupling.rates, coupling.driver, coefficients
