"""The two spaces stay the two spaces."""

from __future__ import annotations

import copy
import pickle

import pytest

from vincula.spatial.space import PLANAR, SPATIAL, Space


@pytest.mark.parametrize("space", [PLANAR, SPATIAL])
def test_a_pickle_is_the_same_space(space: Space) -> None:
    """Code asks `space is PLANAR`: a mechanism sent to another process must still be planar there."""
    assert pickle.loads(pickle.dumps(space)) is space
    assert copy.deepcopy(space) is space
