"""Kinematic efficiencies in 200-digit arithmetic: the peer for accuracy tests."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np
from numpy.typing import NDArray

from vincula.model import LinearModel


def exact_efficiencies(
    model: LinearModel, twist: NDArray[np.float64], rate: NDArray[np.float64]
) -> list[float]:
    """Generalised eigenvalues of (8) for diagonal weights, descending; regular mechanisms only."""
    with mp.workdps(200):
        n_a, n_p = len(model.motors), len(model.passives)
        whole = np.hstack([model.jacobian_active, model.jacobian_passive, -model.grasp.T])
        kernel = _kernel(mp.matrix(whole.tolist()))
        k = kernel.cols
        rates, twists = kernel[:n_a, :], kernel[n_a + n_p :, :]
        upper = twists.T * mp.diag([mp.mpf(float(w)) for w in twist]) * twists
        lower = rates.T * mp.diag([mp.mpf(float(w)) for w in rate]) * rates
        factor = mp.cholesky(lower)
        reduced = mp.inverse(factor) * upper * mp.inverse(factor).T
        values = mp.eigsy((reduced + reduced.T) / 2, eigvals_only=True)
        return sorted((float(values[i]) for i in range(k)), reverse=True)


def _kernel(a: Any) -> Any:
    """Kernel basis by Gauss-Jordan elimination with full pivoting; exact input of full row rank."""
    m, n = a.rows, a.cols
    order = list(range(n))
    for i in range(m):
        r, c = max(
            ((r, c) for r in range(i, m) for c in range(i, n)), key=lambda rc: abs(a[rc[0], order[rc[1]]])
        )
        order[i], order[c] = order[c], order[i]
        if r != i:
            for j in range(n):
                a[i, j], a[r, j] = a[r, j], a[i, j]
        pivot = a[i, order[i]]
        for j in range(n):
            a[i, j] /= pivot
        for other in range(m):
            factor = a[other, order[i]]
            if other != i and factor != 0:
                for j in range(n):
                    a[other, j] -= factor * a[i, j]
    kernel = mp.zeros(n, n - m)
    for k in range(n - m):
        kernel[order[m + k], k] = 1
        for i in range(m):
            kernel[order[i], k] = -a[i, order[m + k]]
    return kernel
