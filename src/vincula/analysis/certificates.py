"""`exact=True`: what can be proved about the ranks of a model, put into its evidence.

With exact data every rank is computed exactly.  Without, ranks are proved from below: they are not
lower for any matrices within all uncertainties.
"""

from __future__ import annotations

from dataclasses import replace

from vincula.model import LinearModel
from vincula.numerics.certify import certified_rank, exact_rank
from vincula.numerics.evidence import Certificate
from vincula.numerics.ledger import MATRIX_NAMES
from vincula.numerics.surds import NotExactError


def certified(model: LinearModel) -> LinearModel:
    """The model with a certificate for each of its eight ranks, its numbers being what was typed.

    Raises:
        MissingExtraError: python-flint is not installed.
    """
    as_typed = replace(model.uncertainty, digits_length=0.0, digits_angle=0.0)
    model = replace(model, uncertainty=as_typed)
    found, basis = _certificates(model)
    return replace(model, evidence=replace(model.evidence, certificates=found, basis=basis))


def _certificates(model: LinearModel) -> tuple[dict[str, Certificate], str]:
    try:
        if model.exact is None:
            raise NotExactError("the matrices are known as rounded doubles")
        blocks = model.exact(model)
        exact = {name: Certificate(exact_rank(blocks.matrix(name)), True) for name in MATRIX_NAMES}
    except NotExactError as reason:
        ledger = model.ledger
        below = {
            str(name): certified_rank(ledger.matrix(name), ledger.decision(name).cutoff)
            for name in MATRIX_NAMES
        }
        why = f"floating matrices within all their uncertainties, from below only ({reason})"
        return below, why
    return {str(name): certificate for name, certificate in exact.items()}, blocks.basis
