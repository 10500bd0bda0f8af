"""pycapacity, where it can do the job: axes and lengths of the velocity and force ellipsoids of a Jacobian.

It takes one Jacobian at a time and knows no closed chains, so it is handed the Jacobian of the platform; only
its own calls are timed.  It draws in GPL software and is installed for this comparison alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from peers.cases import Array, Platform
from peers.floor import inverse_jacobians


def capacity_form(platform: Platform, poses: Array) -> Callable[[], None]:
    """A function that has pycapacity compute both ellipsoids of every pose.

    Raises:
        ImportError: It is not there.
    """
    from pycapacity.robot import force_ellipsoid, velocity_ellipsoid

    jacobians = np.linalg.inv(inverse_jacobians(platform, poses))
    limits = np.ones(6)

    def run() -> None:
        for jacobian in jacobians:
            velocity_ellipsoid(jacobian, limits)
            force_ellipsoid(jacobian, limits)

    return run
