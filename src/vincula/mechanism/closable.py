"""What a mechanism can do beyond one configuration: be closed, followed, enumerated, seen from a body."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, cast

from vincula.arrays import Vector

if TYPE_CHECKING:
    from vincula.mechanism.closed import ClosedConfiguration
    from vincula.mechanism.mechanism import Mechanism
    from vincula.mechanism.paths import Path
    from vincula.mechanism.residuals import LoopResidual
    from vincula.mechanism.watching import SingularityKind
    from vincula.spatial.poses import Pose


class Closable:
    """Closing, following, assembly modes and change of ground, for `Mechanism`."""

    @cached_property
    def misdrawn(self) -> tuple[LoopResidual, ...]:
        """Joints that do not fit between their bodies at home, where those are as they were drawn."""
        from vincula.mechanism.residuals import misdrawn

        return misdrawn(cast("Mechanism", self))

    def close(
        self,
        near: Mapping[str, float | Sequence[float] | Vector] | None = None,
        *,
        motors: Mapping[str, float | Sequence[float] | Vector] | None = None,
        pose: Pose | Sequence[float] | Vector | None = None,
        limits: bool = False,
        attempts: int = 25,
        seed: int = 0,
    ) -> ClosedConfiguration:
        """A configuration that closes all loops, contacts and couplings.

        Damped Gauss-Newton with analytic Jacobians, polished to rounding; what is free stays as near
        to the start as closing permits (radians, and metres / L).  Locked axes stay where they start.

        Args:
            near: Where to start: values by joint, home for the others.
            motors: Values to hold, by joint, axis or motor name [rad, m].
            pose: Where to hold the reference member: the pose of its reference point and body axes in
                ground axes, or the position of the reference point alone [m].
            limits: Whether joint limits are respected.
            attempts: Starts to try: the given one, then random displacements of it.
            seed: Seed of those displacements.

        Raises:
            ClosureError: No closed configuration was found; names the loop and its gap, the best
                configuration, and lengths that cannot meet.
            UnknownNameError: A name that is no joint, axis or motor with a value.
            MissingReferenceError: A pose is asked for and no reference member is named.
        """
        from vincula.mechanism.closure import close

        return close(
            cast("Mechanism", self),
            near,
            motors=motors,
            pose=pose,
            limits=limits,
            attempts=attempts,
            seed=seed,
        )

    def follow(
        self,
        path: Sequence[Mapping[str, float | Sequence[float] | Vector] | Pose | Sequence[float] | Vector],
        *,
        start: Mapping[str, float | Sequence[float] | Vector] | None = None,
        samples: int | None = None,
        limits: bool = True,
        through: Collection[SingularityKind] = (),
    ) -> Path:
        """Closed configurations along a path of motor values or poses, on one assembly branch.

        Motors that the path does not name stand still.  It stops at a singularity (the platform
        becomes free, motors lose authority, inner degeneracy) or a joint limit, and says which, where
        (located to about 1e-12) and why.

        Args:
            path: Where to go, one after the other: values by joint, axis or motor name, or poses of
                the reference member, or positions of the reference point.
            start: Where the path begins: a configuration, home for joints not named; closed first if
                it is open.
            samples: Number of configurations to record, evenly spaced; by default one a waypoint.
            limits: Whether joint limits stop it.
            through: Kinds of singularity to pass where the path goes on beyond them:
                `platform free`, `motors without authority`, `internal`.

        Raises:
            ClosureError: The start cannot be closed.
            ModelError: Waypoints that do not give the same things.
            UnknownNameError: A name that is no joint, axis or motor with a value.
        """
        from vincula.mechanism.following import follow

        return follow(
            cast("Mechanism", self), path, start=start, samples=samples, limits=limits, through=through
        )

    def assembly_modes(
        self,
        motors: Mapping[str, float | Sequence[float] | Vector] | None = None,
        *,
        starts: int = 100,
        seed: int = 0,
        limits: bool = False,
    ) -> tuple[ClosedConfiguration, ...]:
        """All ways found to put the mechanism together at given motor values, each once.

        Args:
            motors: Values to hold; the active axes at home by default.
            starts: Random starts; the first is home.
            seed: Their seed.
            limits: Whether joint limits are respected.

        Raises:
            ModelError: What is held leaves motions free: there are no separate modes.
        """
        from vincula.mechanism.modes import assembly_modes

        return assembly_modes(cast("Mechanism", self), motors, starts=starts, seed=seed, limits=limits)

    def with_ground(self, body: str) -> Mechanism:
        """The same mechanism seen from one of its bodies: that body is the ground from now on.

        The old ground becomes a body called `world`, unless only a free joint led there.  Everything
        in ground axes is in the axes of `body` afterwards.

        Raises:
            UnknownNameError: No such body.
        """
        from vincula.mechanism.grounding import with_ground

        return with_ground(cast("Mechanism", self), body)
