"""What a command is about: the mechanism of FILE with the motors, member and configuration asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Literal, TypeVar, cast

from vincula.cli.exits import BadOptionError
from vincula.cli.page import few
from vincula.errors import ClosureError, MissingReferenceError, ModelError, UnknownNameError
from vincula.mechanism.parts import GROUND

if TYPE_CHECKING:
    from vincula.files.report import LoadReport
    from vincula.mechanism.configuration import Configuration
    from vincula.mechanism.mechanism import Mechanism
    from vincula.model import LinearModel

Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class Subject:
    """A mechanism and the configuration it is looked at.

    Attributes:
        file: FILE as it was written.
        mechanism: The mechanism with everything asked for.
        configuration: Where it is looked at.
        report: What the reader did with the file.
    """

    file: str
    mechanism: Mechanism
    configuration: Configuration
    report: LoadReport

    def with_active(self, text: str | None) -> Subject:
        """The same with other motors; None keeps those of the file."""
        if text is None:
            return self
        return replace(self, mechanism=_usage("--active", lambda: self.mechanism.with_active(text)))

    def with_weights(self, text: str | None) -> Subject:
        """The same with the weights of a `--weights` text; None keeps those of the file."""
        if text is None:
            return self
        from vincula.files.weights import read_weights

        weights = _usage("--weights", lambda: read_weights(text, self.mechanism))
        return replace(self, mechanism=self.mechanism.with_weights(weights))

    def linearize(self) -> LinearModel:
        """J_a, J_p and G at the configuration.

        Raises:
            BadOptionError: No reference member; lists the bodies and the option.
            ClosureError: A loop is open.
        """
        if self.mechanism.reference is None:
            missing = MissingReferenceError(body.name for body in self.mechanism.bodies)
            raise BadOptionError(f"{missing}. Say --reference BODY.")
        try:
            return self.mechanism.linearize(self.configuration)
        except ClosureError as error:
            raise _explained(error, self) from None


def _explained(error: ClosureError, subject: Subject) -> ClosureError:
    """The refusal of an open loop with the closest closed configuration, or why there is none."""
    from vincula.mechanism.open_loops import closest_closed

    closest, text = closest_closed(subject.mechanism, subject.configuration)
    advice = (
        "--close closes it, with the joints that --at names held where they can be."
        if closest is not None
        else "`vincula close` says more."
    )
    first = str(error).partition(" Give values")[0]
    return ClosureError(
        f"{first} {text} {advice}", loop=error.loop, gap=error.gap, **{**error.details, "closest": closest}
    )


def read_subject(
    file: str,
    *,
    parameters: Mapping[str, str],
    lock: str | None,
    reference: str | None,
    axes: str | None,
    at: str | None,
    tolerance: str | None,
    loops: Sequence[str] = (),
    package_dirs: Sequence[str] = (),
    ground: str | None = None,
    closing: bool = False,
    snap: bool = False,
) -> Subject:
    """The mechanism of a file with the common options applied.

    Raises:
        FileError: The file cannot be read.
        ModelError: A name or value in an option that the mechanism does not have.
        BadOptionError: An option that cannot be understood.
    """
    from vincula.files.configuration import read_configuration
    from vincula.files.load import load_with_report
    from vincula.mechanism.grounding import seen_from

    def load() -> tuple[Mechanism, LoadReport]:
        return load_with_report(file, parameters, beside=loops, package_dirs=package_dirs, snap=snap)

    drawn, report = _usage("--set" if parameters else "", load)
    mechanism = drawn
    if ground is not None:
        mechanism = _usage("--ground", lambda: mechanism.with_ground(ground))
    if lock is not None:
        mechanism = _usage("--lock", lambda: mechanism.with_lock(lock))
    mechanism = with_reference(mechanism, reference, axes)
    if tolerance is not None:
        mechanism = mechanism.with_tolerance(*tolerances(tolerance))
    configuration = mechanism.home
    if at is not None:
        values = _usage("--at", lambda: read_configuration(at, drawn, report.units))
        configuration = seen_from(drawn, mechanism, ground, values) if ground is not None else values
    if closing:
        from vincula.cli.closing import closed_near

        configuration = closed_near(mechanism, configuration, drawn, at)
    return Subject(file, mechanism, configuration, report)


def with_reference(mechanism: Mechanism, text: str | None, axes: str | None) -> Mechanism:
    """The mechanism with the reference member of `--reference` and `--axes`."""
    old = mechanism.reference
    chosen = cast("Literal['ground', 'body']", axes or (old.axes if old is not None else "ground"))
    if text is None:
        if old is None or axes is None:
            return mechanism
        return replace(mechanism, reference=replace(old, axes=chosen))
    body, origin, frame = split_reference(mechanism, text.strip())
    return _usage("--reference", lambda: mechanism.with_reference(body, origin, frame=frame, axes=chosen))


def split_reference(mechanism: Mechanism, text: str) -> tuple[str, list[float] | None, str | None]:
    """Body, point and frame of `BODY`, `BODY@FRAME` or `BODY@x,y,z`; a body may have an `@` in its name.

    Raises:
        UnknownNameError: No such body.
    """
    body, at, point = text.rpartition("@")
    if text in mechanism.body or text in ("ground", "world") or not at:
        body, point = text, ""
    if body not in mechanism.body and body not in ("ground", "world"):
        carriers = [frame.body for frame in mechanism.frames if frame.name == body]
        if carriers and carriers[0] == GROUND:
            raise BadOptionError(
                f"--reference: {body!r} is part of the ground here and cannot move; name a body that does "
                f"({few(mechanism.body, 60)}), or see it from there: --ground BODY --reference world@{body}"
            )
        if carriers:
            raise BadOptionError(f"{body!r} is a frame, not a body: say --reference {carriers[0]}@{body}")
        raise UnknownNameError("body", body, mechanism.body)
    if at and not point and text not in mechanism.body:
        raise BadOptionError(f"{text!r} names no point: say BODY, BODY@FRAME or BODY@x,y,z")
    if not point:
        return body, None, None
    coordinates = _numbers(point)
    if coordinates is None or any(f.name == point and f.body == body for f in mechanism.frames):
        return body, None, point
    return body, coordinates, None


def tolerances(text: str) -> tuple[float, float]:
    """Length [m] and angle [rad] of a `--tolerance` text such as `0.1mm,0.05deg`.

    Raises:
        BadOptionError: A negative or repeated tolerance, or no number.
    """
    from vincula.spatial.units import quantity

    found: dict[str, float] = {}
    for part in text.split(","):
        dimension: Literal["length", "angle"] = "angle" if part.strip().endswith(("rad", "deg")) else "length"
        value = _usage("--tolerance", partial(quantity, part, dimension, "tolerance"))
        if value < 0.0 or dimension in found:
            raise BadOptionError(
                f"--tolerance {text!r}: give one length and one angle, not negative, like 0.1mm,0.05deg"
            )
        found[dimension] = value
    return found.get("length", 0.0), found.get("angle", 0.0)


def _numbers(text: str) -> list[float] | None:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        return None


def _usage(option: str, action: Callable[[], Result]) -> Result:
    """What the action returns; a refusal is the fault of what was written in the option."""
    try:
        return action()
    except ModelError as error:
        if isinstance(error, UnknownNameError) and error.kind == "example":
            raise  # FILE itself, whatever the options say
        raise BadOptionError(f"{option}: {error}" if option else str(error)) from error
