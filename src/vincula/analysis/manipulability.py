"""The five ellipsoids.  Source: eqs. (8)-(13), (20)-(24); theory page, sections 4 and 5."""

from __future__ import annotations

from vincula.analysis.doubt import warn_of_doubt, warn_of_mixed_units
from vincula.analysis.ellipsoid import Convention, Ellipsoid, Kind, Viewpoint
from vincula.analysis.recipes import ellipsoid_of_kind, resolved_weights, task_quantity
from vincula.model import LinearModel
from vincula.weights import Weights


def kinematic_ellipsoid(
    model: LinearModel,
    weights: Weights | None = None,
    *,
    viewpoint: Viewpoint = "efficiency",
    convention: Convention = "invariant",
) -> Ellipsoid:
    """Twists of the member per unit of motor rate: eqs. (8), (11)-(13).

    Redundancy is used as well as possible, indeterminacy taken at its worst.  Efficiencies are
    infinite for motions with all motors locked, zero for motor motions that leave the member at rest.

    Args:
        model: The mechanism at one configuration.
        weights: W_u and W_q; the model's own, else the identity in m, rad, when not given.
        viewpoint: efficiency (speed per motor speed) or accuracy (error per motor error).
        convention: Makes no difference here.

    Warns:
        RankAmbiguityWarning: The counts depend on singular values within the uncertainty.
        MixedUnitsWarning: Metres and radians are added with weights that nobody chose.
    """
    return _warned("kinematic", model, weights, viewpoint, convention)


def active_force_ellipsoid(
    model: LinearModel,
    weights: Weights | None = None,
    *,
    viewpoint: Viewpoint = "efficiency",
    convention: Convention = "invariant",
) -> Ellipsoid:
    """Wrenches that the motors push through the member, per unit of torque: eq. (20).

    Wrenches are minimised over structural ones, the torque of squeezing counts: internal torques
    appear with efficiency zero.  Arguments and warnings as for `kinematic_ellipsoid`, with W_w and
    W_tau; `convention="printed"` gives the numbers printed in the paper (theory page, section 5).
    """
    return _warned("active force", model, weights, viewpoint, convention)


def passive_force_ellipsoid(
    model: LinearModel,
    weights: Weights | None = None,
    *,
    viewpoint: Viewpoint = "efficiency",
    convention: Convention = "invariant",
) -> Ellipsoid:
    """Wrenches that the mechanism resists, per unit of torque: eq. (21).

    Torques are minimised over internal ones; structural wrenches cost no torque: efficiency
    infinity, the set is a cylinder along them.  Arguments and warnings as for
    `active_force_ellipsoid`.
    """
    return _warned("passive force", model, weights, viewpoint, convention)


def internal_force_ellipsoid(
    model: LinearModel,
    weights: Weights | None = None,
    *,
    viewpoint: Viewpoint = "efficiency",
    convention: Convention = "invariant",
) -> Ellipsoid:
    """Contact forces of squeezing (no net wrench) per unit of torque: eqs. (22)-(23).

    Forces carried without any torque (static indeterminacy) are infinite, the finite ones minimised
    over them.  Depends on where the graph was cut (see `model.cuts`).  Arguments and warnings as for
    `kinematic_ellipsoid`, with W_f and W_tau.
    """
    return _warned("internal force", model, weights, viewpoint, convention)


def dual_force_ellipsoid(
    model: LinearModel,
    weights: Weights | None = None,
    *,
    viewpoint: Viewpoint = "efficiency",
    convention: Convention = "invariant",
) -> Ellipsoid:
    """The force problem dual to the kinematic one: eq. (24).

    Optimised over internal torques, worst case over structural wrenches.  With W_w = W_u^-1 and
    W_tau = W_q^-1 its efficiencies are the reciprocals of the finite kinematic ones.  Arguments and
    warnings as for `kinematic_ellipsoid`, with W_w and W_tau.
    """
    return _warned("dual force", model, weights, viewpoint, convention)


def _warned(
    kind: Kind,
    model: LinearModel,
    weights: Weights | None,
    viewpoint: Viewpoint,
    convention: Convention,
) -> Ellipsoid:
    used = resolved_weights(model, weights)
    found = ellipsoid_of_kind(kind, model, used, viewpoint, convention)
    warn_of_doubt(model)
    warn_of_mixed_units(model, used, task_quantity(kind))
    return found
