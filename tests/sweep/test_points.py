"""Points, chunks and fingerprints: values that depend on nothing but what was asked for."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import vincula as vc
from vincula.sweep.chunks import MOST_CHUNKS, Chunking, near_walk
from vincula.sweep.fingerprint import fingerprint
from vincula.sweep.rotations import from_roll_pitch_yaw, roll_pitch_yaw

shapes = st.lists(st.integers(1, 7), min_size=1, max_size=4).map(tuple)


@given(shapes, st.data())
def test_chunks_cover_every_point_once(shape: tuple[int, ...], data: st.DataObject) -> None:
    block = tuple(data.draw(st.integers(1, n)) for n in shape)
    chunking = Chunking.of(shape, block)
    every = np.concatenate([chunking.indices(k) for k in range(chunking.count)])
    assert sorted(every) == list(range(int(np.prod(shape))))
    whole = np.arange(np.prod(shape)).reshape(shape)
    for k in range(chunking.count):
        assert np.array_equal(whole[chunking.slices(k)].ravel(), chunking.indices(k))


def test_chunk_sizes_depend_on_the_number_of_points_alone() -> None:
    assert Chunking.of((100,)).block == (100,)
    assert Chunking.of((20_000,)).block == (1024,)
    assert Chunking.of((200_000,)).block == (3125,)
    assert Chunking.of((10_000_000,)).block == (65_536,)
    assert Chunking.of((1000, 1000)).block == (15, 1000)
    assert Chunking.of((10**10,)).count <= MOST_CHUNKS
    for bad in (0, -1, (2, 2, 2), (0, 1), True):
        with pytest.raises(vc.ModelError):
            Chunking.of((5, 5), bad)
    with pytest.raises(vc.ModelError, match="larger chunks"):
        Chunking.of((10**8,), 10)


SETS = [
    vc.RandomPoints({"a": (0, 1), "b": (-1, 2), "c": (5, 6)}, 500, 3),
    vc.LowDiscrepancyPoints({"a": (0, 1), "b": (-1, 2), "c": (5, 6)}, 500, 3),
    vc.LowDiscrepancyPoints({"a": (0, 1), "b": (-1, 2), "c": (5, 6)}, 500, 3, "halton"),
    vc.Polyline([{"a": 0, "b": 1}, {"b": 2, "a": 1}, {"a": 0, "b": 0}], 101),
    vc.PointTable({"a": np.arange(50.0), "b": np.arange(50.0) ** 2}),
    vc.Grid({"a": [1.0, 2.0], "b": np.arange(3.0), "c": [0.0]}),
]


@pytest.mark.parametrize("points", SETS, ids=lambda points: type(points).__name__)
def test_any_stretch_is_the_same_as_in_the_whole(points: vc.Grid) -> None:
    whole = points.at(np.arange(points.count))
    assert whole.shape == (points.count, len(points.variables))
    for begin in (3, 0, 1, points.count // 2, points.count - 1):
        stretch = np.arange(begin, points.count)
        assert np.array_equal(points.at(stretch), whole[stretch])
    assert fingerprint(points.description()) == fingerprint(pickle.loads(pickle.dumps(points)).description())


def test_random_points_fill_their_ranges() -> None:
    for points in SETS[:3]:
        values = points.at(np.arange(500))
        assert (values >= [0, -1, 5]).all()
        assert (values <= [1, 2, 6]).all()
        assert np.abs(values.mean(axis=0) - [0.5, 0.5, 5.5]).max() < 0.15
    one, two = (vc.RandomPoints({"a": (0, 1)}, 5, seed).at(np.arange(5)) for seed in (1, 2))
    assert not np.array_equal(one, two)


def test_a_polyline_passes_its_waypoints() -> None:
    values = SETS[3].at(np.arange(101))
    assert np.array_equal(values[[0, 50, 100]], [[0, 1], [1, 2], [0, 0]])


def test_scattered_points_are_walked_with_short_steps(rng: np.random.Generator) -> None:
    values = rng.random((4096, 2))
    order = near_walk(values)
    assert sorted(order) == list(range(4096))
    walked = np.linalg.norm(np.diff(values[order], axis=0), axis=1).mean()
    assert walked < 0.1 * np.linalg.norm(np.diff(values, axis=0), axis=1).mean()


@pytest.mark.parametrize(
    ("make", "kind", "words"),
    [
        (lambda: vc.Grid([("a", [1.0]), ("a", [2.0])]), vc.DuplicateNameError, "two variables are named 'a'"),
        (lambda: vc.Grid({}), vc.ModelError, "at least one variable"),
        (lambda: vc.Grid({"a": []}), vc.ModelError, "no points"),
        (lambda: vc.Grid({"a": [1.0, float("nan")]}), vc.NonFiniteError, "nan"),
        (
            lambda: vc.Grid({k: np.arange(1000.0) for k in "abcd"}),
            vc.ModelError,
            "1e.12 points, at most 1e.10",
        ),
        (lambda: vc.RandomPoints({"a": (1, 0)}, 5), vc.ModelError, "must be the smaller"),
        (lambda: vc.RandomPoints({"a": (0, 1)}, 10**12), vc.ModelError, "at most"),
        (lambda: vc.RandomPoints({"a": (0, 1)}, 5, seed=-1), vc.ModelError, "seed"),
        (lambda: vc.LowDiscrepancyPoints({"a": (0, 1)}, 5, 0, "other"), vc.ModelError, "sobol or halton"),
        (lambda: vc.Polyline([{"a": 0.0}], 5), vc.ModelError, "two waypoints"),
        (lambda: vc.Polyline([{"a": 0.0}, {"b": 0.0}], 5), vc.ModelError, "the same variables"),
        (lambda: vc.PointTable({"a": [1.0], "b": [1.0, 2.0]}), vc.ShapeError, "column 'b'"),
    ],
)
def test_bad_points_are_refused(make: object, kind: type[Exception], words: str) -> None:
    with pytest.raises(kind, match=words):
        make()  # type: ignore[operator]


@given(st.lists(st.floats(-1.5, 1.5), min_size=3, max_size=3))
def test_roll_pitch_yaw(angles: list[float]) -> None:
    """Against scipy's turns about fixed axes, and back."""
    quaternion = from_roll_pitch_yaw(*(np.array([angle]) for angle in angles))[0]
    expected = Rotation.from_euler("xyz", angles).as_quat()[[3, 0, 1, 2]]
    assert abs(abs(quaternion @ expected) - 1.0) < 1e-14
    assert np.abs(roll_pitch_yaw(quaternion) - angles).max() < 1e-13


def test_fingerprints_see_every_change_but_not_the_last_bits() -> None:
    one, two = vc.load("example:stewart"), vc.load("example:stewart")
    assert fingerprint(one) == fingerprint(two) == fingerprint(pickle.loads(pickle.dumps(one)))
    assert fingerprint(vc.load("example:stewart", {"height": 2.000001})) != fingerprint(one)
    assert fingerprint(one.with_active(["p1"])) != fingerprint(one)
    assert fingerprint({"a": 0.1 + 0.2, "b": [0.0]}) == fingerprint({"b": [-1e-17], "a": 0.3})
    assert fingerprint([1.0]) != fingerprint([1.000000001])
    with pytest.raises(vc.ModelError, match="no content"):
        fingerprint({"f": print})
