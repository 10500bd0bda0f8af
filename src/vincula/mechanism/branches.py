"""Names of assembly branches.

Two configurations with the same motor positions are on different branches when a singularity lies
between them.  A branch is named by signs of determinants: with the motors locked (assembly: which side
the platform is on) and with the reference member locked (working: which way every leg is bent), one
sign an independent group of loops, plus meaning "as at home".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Matrix
from vincula.errors import ClosureError
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.watching import decided, measured
from vincula.model import LinearModel
from vincula.numerics.lapack import singular_values

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

CLEAR: Final = 1e-3
"""A reduced determinant whose smallest factor is below this share of the regular one names no side."""


@dataclass(frozen=True, slots=True)
class Branch:
    """The name of an assembly branch.

    Attributes:
        assembly: Signs with the motors locked: + as at home, - other side, 0 singular, ? no sign.
        working: Signs with the reference member locked.
    """

    assembly: str
    working: str

    def __str__(self) -> str:
        return f"assembly {self.assembly or 'none'}, working {self.working or 'none'}"


def branch_of(mechanism: Mechanism, q: Configuration) -> Branch:
    """The branch of a closed configuration; no signs where no reference member is named."""
    if mechanism.reference is None:
        return Branch("", "")
    here = mechanism.linearize(q)
    try:
        home: LinearModel | None = mechanism.linearize()
    except ClosureError:
        home = None
    return Branch(_signs(here, home, _motors_locked), _signs(here, home, _member_locked))


@dataclass(frozen=True, slots=True, eq=False)
class _Block:
    """Columns of a linear model, with what every row and column belongs to."""

    matrix: Matrix
    sources: tuple[str, ...]
    owners: tuple[str, ...]


def _motors_locked(model: LinearModel) -> _Block:
    scaled = model.scaled
    owners = (*(c.joint for c in model.passives), *("",) * scaled.member.shape[1])
    return _Block(np.hstack([scaled.passive, -scaled.member]), _sources(model), owners)


def _member_locked(model: LinearModel) -> _Block:
    scaled = model.scaled
    owners = tuple(c.joint for c in (*model.motors, *model.passives))
    return _Block(np.hstack([scaled.active, scaled.passive]), _sources(model), owners)


def _sources(model: LinearModel) -> tuple[str, ...]:
    return tuple(row.source for row in model.rows)


def _signs(here: LinearModel, home: LinearModel | None, block: Callable[[LinearModel], _Block]) -> str:
    """One sign a group of loops and joints that have nothing to do with the others."""
    now, then = block(here), None if home is None else block(home)
    touched: Mask = now.matrix != 0.0
    if then is not None:
        touched |= then.matrix != 0.0
    signs = ""
    for rows, columns in _groups(touched, now.sources, now.owners):
        part = np.ix_(rows, columns)
        signs += _sign(
            now.matrix[part], here.uncertainty.residual, None if then is None else then.matrix[part]
        )
    return signs


def _groups(
    touched: Mask, sources: tuple[str, ...], owners: tuple[str, ...]
) -> list[tuple[list[int], list[int]]]:
    """Rows and columns of every group: loops that share a joint, in the order of the joints.

    Whole loops and joints are joined, so that an entry that happens to vanish splits no group.
    """
    group = {owner: k for k, owner in enumerate(dict.fromkeys(owners))}
    reached: dict[str, list[str]] = {}
    for row, column in np.argwhere(touched):
        reached.setdefault(sources[row], []).append(owners[column])
    for members in reached.values():
        merged = {group[owner] for owner in members}
        group = {owner: min(merged) if g in merged else g for owner, g in group.items()}
    found = []
    for label in sorted(set(group.values())):
        columns = [k for k, owner in enumerate(owners) if group[owner] == label]
        rows = [k for k, source in enumerate(sources) if label in {group[o] for o in reached.get(source, ())}]
        if rows:
            found.append((rows, columns))
    return found


def _sign(now: Matrix, residual: float, home: Matrix | None) -> str:
    """Sign of the determinant against home; of the plain determinant where home is open or singular."""
    rank = decided(now, residual).rank
    generic = rank if home is None else decided(home, 0.0).rank
    if rank < generic:
        return "0"
    if home is None or generic < rank:
        square = now.shape[0] == now.shape[1] == rank
        return _of(float(np.linalg.slogdet(now)[0])) if square else "?"
    base = measured(home, rank)
    reduced = base.left[:, :rank].T @ now @ base.right[:, :rank]
    if rank and singular_values(reduced)[-1] < CLEAR * measured(now, rank).smallest:
        return "?"
    return _of(float(np.linalg.slogdet(reduced)[0]))


def _of(sign: float) -> str:
    return "+" if sign > 0.0 else "-"
