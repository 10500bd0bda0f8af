"""What closing and following are asked to hold, as it is written on the command line."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.cli.exits import BadOptionError
from vincula.errors import FileError, ModelError

if TYPE_CHECKING:
    from vincula.arrays import Vector
    from vincula.cli.subject import Subject
    from vincula.mechanism.following import Waypoint
    from vincula.mechanism.holding import MotorValues
    from vincula.spatial.poses import Pose

ROWS: Final = 1_000_000
"""Most rows of a path file."""


def motor_values(subject: Subject, option: str, text: str) -> MotorValues:
    """Values of `name=value,...` by joint, axis or motor name [m, rad].

    Raises:
        BadOptionError: A text, a name or a value that cannot be used.
    """
    from vincula.files.configuration import assignments

    try:
        return {name: _value(subject, name, words) for name, words in assignments(text).items()}
    except ModelError as error:
        raise BadOptionError(f"{option}: {error}") from error


def _value(subject: Subject, name: str, words: Sequence[str]) -> Vector | float:
    """The values of one name: a motor over several axes, a joint, or one axis of it."""
    from vincula.files.configuration import read_configuration
    from vincula.files.joint_values import JointValues
    from vincula.mechanism.residuals import axis_linear

    mechanism, units = subject.mechanism, subject.report.units
    target = name if name in mechanism.joint else mechanism.motors.get(name, name)
    drive = next((d for d in mechanism.drives if d.name == target), None)
    if drive is not None:
        in_metres = axis_linear(mechanism)
        linear = any(in_metres[axis] for axis in drive.drives) if drive.linear is None else drive.linear
        return _number(subject, words, linear, name)
    joint, index = JointValues(mechanism, units).joint_of(target)
    text = f'"{target}"=[{",".join(words)}]'
    values = read_configuration(text, mechanism, units)[joint.name]
    return np.asarray(values) if index is None else float(values[index])


def _number(subject: Subject, words: Sequence[str], linear: bool, name: str) -> float:
    """A length or angle, in the units of the file or with its own unit [m, rad]."""
    from vincula.files.digits import is_number
    from vincula.spatial.units import quantity

    if len(words) != 1:
        raise ModelError(f"{name} has one value, got {len(words)}")
    if is_number(words[0]):
        return subject.report.units.inside(quantity(words[0], "number", name), linear)
    return quantity(words[0], "length" if linear else "angle", name)


def point_or_pose(subject: Subject, option: str, text: str, *, pose: bool) -> Pose | Vector:
    """A position `x,y[,z]`, or a pose `x,y,angle` or `x,y,z,qw,qx,qy,qz`.

    Raises:
        BadOptionError: The wrong number of values, or no numbers.
    """
    from vincula.spatial.poses import Pose

    s = subject.mechanism.space.translations
    words = [word.strip() for word in text.split(",")]
    count = s if not pose else 3 if s == 2 else 7
    form = ("x,y" if s == 2 else "x,y,z") if not pose else ("x,y,angle" if s == 2 else "x,y,z,qw,qx,qy,qz")
    if len(words) != count:
        raise BadOptionError(f"{option} {text!r}: expected {form}")
    try:
        at = [_number(subject, [word], True, form.split(",")[k]) for k, word in enumerate(words[:s])]
        if not pose:
            return np.array(at)
        if s == 2:
            return Pose.from_angle(_number(subject, words[2:], False, "angle"), at)
        quaternion = [float(word) for word in words[3:]]
    except (ModelError, ValueError) as error:
        raise BadOptionError(f"{option} {text!r}: expected {form} ({error})") from error
    if not np.isfinite(quaternion).all() or np.linalg.norm(quaternion) < 1e-6:
        raise BadOptionError(f"{option} {text!r}: the quaternion qw,qx,qy,qz has no direction")
    return Pose.from_quaternion_wxyz(quaternion, at)


def path_file(subject: Subject, file: str) -> list[Waypoint]:
    """Waypoints of a CSV file: a row of joint, axis or motor names, then rows of values.

    Raises:
        FileError: The file cannot be read, or is no such table.
        BadOptionError: A name or value that cannot be used.
    """
    from vincula.files.source import open_source

    rows = [row for row in csv.reader(open_source(file).text.splitlines(), skipinitialspace=True) if row]
    if len(rows) < 2 or len(rows) > ROWS:
        raise FileError(f"{file}: expected a row of names and then at least one row of values")
    names = [name.strip() for name in rows[0]]
    waypoints: list[Waypoint] = []
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(names):
            raise FileError(f"{file}:{line}: {len(row)} values for {len(names)} names")
        values: Mapping[str, str] = dict(zip(names, row, strict=True))
        text = ",".join(f'"{name}"={value.strip()}' for name, value in values.items())
        waypoints.append(motor_values(subject, f"{file}:{line}", text))
    return waypoints
