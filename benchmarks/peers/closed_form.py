"""JAX: the same closed form as the floor's, `jit(vmap(...))` in double precision."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from peers.cases import Array, Platform


def jax_form(platform: Platform) -> Callable[[Array], tuple[Any, ...]]:
    """A function poses -> kinematic and force efficiencies with both sets of axes; blocks until done.

    Raises:
        ImportError: JAX is not there.
    """
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    base, upper = jnp.array(platform.base), jnp.array(platform.upper)

    def one(pose: Any) -> tuple[Any, ...]:
        w, x, y, z = pose[3:]
        turn = jnp.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )
        arms = upper @ turn.T
        legs = arms + pose[:3] - base
        unit = legs / jnp.linalg.norm(legs, axis=1, keepdims=True)
        motors, values, twists = jnp.linalg.svd(jnp.concatenate([unit, jnp.cross(arms, unit)], axis=1))
        return values[::-1] ** -2, values**2, twists[::-1], motors.T[::-1]

    compiled = jax.jit(jax.vmap(one))
    return lambda poses: jax.block_until_ready(compiled(poses))
