"""Designs in order: by which number, and who comes last and why."""

from __future__ import annotations

import numpy as np
import pytest

from vincula.analysis.ranking import CRITERIA, ranked_designs
from vincula.analysis.result import Analysis, analyze
from vincula.errors import MixedUnitsError, UnknownNameError
from vincula.mechanism.catalog.registry import example


def designs(*choices: str) -> list[Analysis]:
    linkage = example("five-bar")
    return [analyze(linkage.with_active(choice).linearize()) for choice in choices]


def order(analyses: list[Analysis], criterion: str = "kinematic") -> list[str]:
    return [
        ",".join(column.name for column in design.analysis.model.motors)
        for design in ranked_designs(analyses, criterion)
    ]


def test_fast_designs_first_by_speed_and_strong_ones_by_force() -> None:
    three = designs("all", "o2,o4", "o1,o5")
    everything = "o1,o2,o3,o4,o5"
    assert order(three, "kinematic") == ["o1,o5", "o2,o4", everything]
    assert order(three, "active-force") == [everything, "o2,o4", "o1,o5"]


def test_indeterminate_designs_come_last_whatever_their_number() -> None:
    ranked = ranked_designs(designs("o1", "", "o1,o5", "o2,o4"))
    assert [len(design.analysis.model.motors) for design in ranked] == [2, 2, 1, 0]
    assert ranked[2].index == pytest.approx(4.0)  # larger than all the others
    assert [design.reason for design in ranked[:2]] == ["", ""]
    assert "moves in 1 way with all motors locked" in ranked[2].reason
    assert "moves in 2 ways" in ranked[3].reason


def test_designs_without_the_number_come_behind_those_that_have_it() -> None:
    ranked = ranked_designs(designs("o1,o5", "all"), "internal-force")
    assert ranked[0].index == pytest.approx(0.1395, abs=5e-5)
    assert ranked[1].index is None
    assert "no smallest finite internal force efficiency" in ranked[1].reason


@pytest.mark.parametrize("criterion", CRITERIA)
def test_every_criterion_is_sorted_descending(criterion: str) -> None:
    indices = [design.index for design in ranked_designs(designs("o2,o4", "o1,o5", "all"), criterion)]
    known = [index for index in indices if index is not None]
    assert known == sorted(known, reverse=True)
    assert known


def test_indices_agree_with_the_ellipsoid() -> None:
    (one,) = ranked_designs(designs("o1,o5"), "yoshikawa", "translation")
    shadow = one.analysis.kinematic.project([0, 1])
    singular = np.linalg.svd(shadow.axes, compute_uv=False)
    assert one.index == pytest.approx(np.prod(singular))


def test_an_index_over_mixed_units_needs_weights() -> None:
    linkage = example("five-bar").with_weights(None)
    with pytest.warns(UserWarning, match="metres and radians"):
        analysis = analyze(linkage.linearize())
    with pytest.raises(MixedUnitsError):
        ranked_designs([analysis], "yoshikawa")
    assert ranked_designs([analysis], "yoshikawa", "translation")[0].index


def test_an_unknown_criterion_lists_the_known_ones() -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'isotropy'"):
        ranked_designs(designs("o1,o5"), "isotropi")
