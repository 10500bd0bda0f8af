"""From an orthonormal kernel to few simple motions: each over as few joints as possible.

An orthonormal basis mixes everything with everything; six legs that spin freely come out as six
mixtures.  The echelon form on well-chosen pivots separates them: independent parts of a kernel own
their pivots, so every vector stays inside one part.
"""

from __future__ import annotations

import numpy as np

from vincula.arrays import Matrix
from vincula.numerics.rank import decide_rank, negligible
from vincula.numerics.subspaces import leading_rows


def localised(basis: Matrix, preferred: slice | None = None, doubt: float = 0.0) -> Matrix:
    """The same subspace in echelon form, columns scaled to a largest component of one.

    Args:
        basis: n x k independent columns.
        preferred: Rows among which pivots are sought, if the columns are independent there.
        doubt: Relative uncertainty of the subspace: components below it are set to zero.
    """
    k = basis.shape[1]
    if k == 0:
        return basis
    everywhere = np.arange(basis.shape[0])
    rows = everywhere[preferred or slice(None)]
    if decide_rank(basis[rows], scale=1.0, uncertainty={"subspace": doubt}).rank < k:
        rows = everywhere  # doubtful ranks: the wanted rows cannot tell the columns apart
    chosen = rows[leading_rows(basis[rows], k)]
    simple = basis @ np.linalg.inv(basis[chosen])
    simple = simple / np.abs(simple).max(axis=0)
    clean = [[0.0 if negligible(abs(x), 1.0, doubt) else x for x in row] for row in simple.tolist()]
    return np.array(clean)[:, np.argsort(chosen, kind="stable")]
