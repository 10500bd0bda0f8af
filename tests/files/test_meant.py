"""What a typed number was probably meant to be."""

from __future__ import annotations

import math

import pytest

from vincula.files.meant import (
    angle_doubt,
    direction_doubt,
    meant_angle,
    meant_direction,
    meant_length,
    meant_quaternion,
)


@pytest.mark.parametrize(
    ("text", "part"),
    [("1.57", 2), ("1.5708", 2), ("1.57075", 2), ("1.570796", 2), ("3.14", 1), ("3.1415", 1), ("-1.57", -2),
     ("0.785", 4), ("0.7853", 4), ("1.047", 3), ("0.262", 12)],
)  # fmt: skip
def test_angles_that_mean_a_part_of_a_turn(text: str, part: int) -> None:
    meant = meant_angle(text)
    assert meant is not None
    assert meant.value == pytest.approx(math.pi / part, rel=1e-15)
    assert angle_doubt(text) == pytest.approx(abs(float(text) - math.pi / part), rel=1e-9)


@pytest.mark.parametrize(
    "text",
    ["1", "0.5", "0.79", "1.05", "1.58", "1.5713", "0.26", "1.5707963267948966", "1.570796326794896558"],
)
def test_angles_taken_as_they_are(text: str) -> None:
    assert meant_angle(text) is None
    assert angle_doubt(text) == 0.0


def test_degrees() -> None:
    assert meant_angle("90", degrees=True) is None
    assert meant_angle("361", degrees=True) is None
    meant = meant_angle("45.0002", degrees=True)
    assert meant is not None
    assert meant.value == 45.0


def test_what_an_exporter_leaves_of_zero() -> None:
    meant = meant_angle("-3.67320510341371E-06")
    assert meant is not None
    assert meant.value == 0.0
    assert meant_angle("0.0002") is None


def test_directions() -> None:
    found = meant_direction(["0.866", "0.5", "0"])
    assert found is not None
    assert [m.words for m in found] == ["sqrt(3/4)", "1/2", "0"]
    assert math.hypot(*(m.value for m in found)) == pytest.approx(1.0, abs=1e-15)
    # Normalising makes these exact: nothing has to be known about them.
    assert meant_direction(["0.7071", "0", "0.7071"]) is None
    assert meant_direction(["0.6", "0.8", "0"]) is None
    assert meant_direction(["1", "2", "3"]) is None
    assert direction_doubt(["0", "0.00003", "1"]) == pytest.approx(3e-5, rel=1e-6)


def test_quaternions() -> None:
    found = meant_quaternion(["0.924", "0.383", "0", "0"])
    assert found is not None
    assert found[0].value == pytest.approx(math.cos(math.pi / 8), rel=1e-15)
    assert meant_quaternion(["0.5", "0.5", "0.5", "0.5"]) is None
    assert meant_quaternion(["0.9", "0.1", "0.3", "0.2"]) is None


def test_lengths_mean_a_longer_one_of_the_file() -> None:
    meant = meant_length("-0.2598", ["0.25981", "0.2598"])
    assert meant is not None
    assert meant.value == -0.25981
    assert meant_length("0.2598", ["0.25981", "0.25982"]) is None  # which one?
    assert meant_length("0.26", ["0.25981"]) is None  # two digits are no rounding
