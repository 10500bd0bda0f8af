"""Figures of mechanisms and their ellipsoids: what `vincula plot` draws.

Needs the extra `plot` (matplotlib).  Figures are objects of their own: nothing here touches pyplot,
opens a window or leaves a setting behind.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from vincula.analysis import manipulability
from vincula.analysis.ellipsoid import Ellipsoid, Kind
from vincula.arrays import Vector
from vincula.errors import MissingExtraError, MissingReferenceError, ModelError, UnknownNameError
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import _All
from vincula.spatial.space import PLANAR
from vincula.view import layout, shapes, style
from vincula.view.scene import scene
from vincula.view.sheet import Panel, Sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vincula.view.drawables import Scene
    from vincula.weights import Weights

Values = Mapping[str, float | Sequence[float] | Vector]
Motors = Iterable[str] | str | _All

KINDS: tuple[Kind, ...] = tuple(shapes.VIEW_OF)
"""The ellipsoids that can be drawn: kinematic, active force, passive force, dual force."""

FORMATS = (".svg", ".png", ".pdf")
"""File formats, by the end of the file's name."""

NAMED_UP_TO = 12
"""Mechanisms with more joints are drawn without names unless they are asked for."""

DOUBT = "A rank is doubtful here: another reading may have other infinite or zero efficiencies."

_FUNCTIONS = {
    "kinematic": manipulability.kinematic_ellipsoid,
    "active force": manipulability.active_force_ellipsoid,
    "passive force": manipulability.passive_force_ellipsoid,
    "dual force": manipulability.dual_force_ellipsoid,
}


def plot_mechanism(
    mechanism: Mechanism,
    q: Values | None = None,
    *,
    ellipsoids: Sequence[Kind] | None = None,
    weights: Weights | None = None,
    names: bool | None = None,
    width: float | None = None,
    direction: tuple[float, float] = (22.0, -62.0),
) -> Figure:
    """A mechanism with its ellipsoids at the reference point, as in the paper's Figs. 5-7.

    One panel an ellipsoid: shadows of the kinematic, active and dual (OWFME) sets on the drawn
    translations, the cut of the passive one, its unbounded line dashed.

    Args:
        mechanism: The mechanism, motors and reference member chosen.
        q: Configuration; the home configuration by default.
        ellipsoids: Which, in order; by default all four, or none without a reference member.  An
            empty list draws the mechanism alone.
        weights: Weights of the ellipsoids; the mechanism's own by default.
        names: Whether the first panel (of every row) names the joints; by default up to 12 joints.
        width: Width of the figure [inch]; a journal's column in the plane, its page in space.
        direction: Elevation and azimuth of the view of a spatial mechanism [deg].

    Raises:
        MissingExtraError: matplotlib is not installed.
        UnknownNameError: An ellipsoid that cannot be drawn.
        MissingReferenceError: Ellipsoids are asked for and no reference member is named.
        ClosureError: Ellipsoids are asked for and a loop is open.
    """
    need_matplotlib()
    kinds = _kinds(mechanism, ellipsoids)
    planar = mechanism.space is PLANAR
    paper = width if width is not None else (layout.COLUMN if planar or len(kinds) < 2 else layout.PAGE)
    panels, remark = _panels([mechanism], q, kinds, weights, [""])
    columns = layout.columns_for(len(panels), 2 if paper < 5.0 or not planar else 4)
    return _figure(panels, Sheet(paper, columns, wants_names(mechanism, names), direction, remark))


def plot_comparison(
    mechanism: Mechanism,
    designs: Sequence[Motors],
    q: Values | None = None,
    *,
    ellipsoids: Sequence[Kind] | None = None,
    weights: Weights | None = None,
    names: bool | None = None,
    width: float = layout.PAGE,
    direction: tuple[float, float] = (22.0, -62.0),
) -> Figure:
    """Several choices of motors, a row each, with their ellipsoids side by side.

    An ellipsoid has the same scale in every row, so sizes can be compared.

    Args:
        mechanism: The mechanism.
        designs: Choices of motors: names, or `ALL`.
        q: Configuration; the home configuration by default.
        ellipsoids: Which, in order; all four by default.
        weights: Weights of the ellipsoids; the mechanism's own by default.
        names: Whether the first panel (of every row) names the joints; by default up to 12 joints.
        width: Width of the figure [inch].
        direction: Elevation and azimuth of the view of a spatial mechanism [deg].

    Raises:
        MissingExtraError: matplotlib is not installed.
        ModelError: No choice of motors.
        UnknownNameError: A motor that does not exist, or an ellipsoid that cannot be drawn.
        MissingReferenceError: No reference member is named.
        ClosureError: A loop is open.
    """
    need_matplotlib()
    if not designs:
        raise ModelError("a comparison needs at least one choice of motors")
    kinds = _kinds(mechanism, ellipsoids)
    variants = [mechanism.with_active(motors) for motors in designs]
    panels, remark = _panels(variants, q, kinds, weights, [motors_text(variant) for variant in variants])
    return _figure(panels, Sheet(width, max(1, len(kinds)), wants_names(mechanism, names), direction, remark))


def save_figure(figure: Figure, path: str | Path) -> Path:
    """Write a figure as SVG, PNG or PDF, the same bytes every time.

    Raises:
        UnknownNameError: Another ending.
        OSError: The file cannot be written.
    """
    target = Path(path)
    ending = target.suffix.lower()
    if ending not in FORMATS:
        raise UnknownNameError("figure format", ending or target.name, FORMATS)
    stamps = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {"Software": None}}
    with drawing_settings():
        figure.savefig(target, format=ending[1:], metadata=stamps[ending])
    return target


def motors_text(mechanism: Mechanism, most: int = 8) -> str:
    """The chosen motors in a line."""
    chosen = mechanism.active
    if not chosen:
        return "no motors"
    if len(chosen) > 2 and chosen == mechanism.resolve_motors("all"):
        return f"all {len(chosen)} joint axes driven"
    more = f" and {len(chosen) - most} more" if len(chosen) > most else ""
    return f"motors {', '.join(chosen[:most])}{more}"


def _kinds(mechanism: Mechanism, ellipsoids: Sequence[Kind] | None) -> tuple[Kind, ...]:
    if ellipsoids is None:
        return KINDS if mechanism.reference is not None else ()
    for kind in ellipsoids:
        if kind not in KINDS:
            raise UnknownNameError("ellipsoid to draw", str(kind), KINDS)
    if ellipsoids and mechanism.reference is None:
        raise MissingReferenceError(body.name for body in mechanism.bodies)
    return tuple(ellipsoids)


def wants_names(mechanism: Mechanism, names: bool | None) -> bool:
    """Whether joints are named: as asked, else where there are few of them."""
    if names is not None:
        return names
    return len(mechanism.joints) <= NAMED_UP_TO


def _panels(
    variants: Sequence[Mechanism],
    q: Values | None,
    kinds: Sequence[Kind],
    weights: Weights | None,
    headers: Sequence[str],
) -> tuple[list[Panel], str]:
    """Panels row by row, and a remark where ranks are in doubt; every kind of ellipsoid has one scale."""
    scenes = [scene(variant, q) for variant in variants]
    if not kinds:
        return [Panel(one, None, header) for one, header in zip(scenes, headers, strict=True)], ""
    models = [variant.linearize(q) for variant in variants]
    found = [[_FUNCTIONS[kind](model, weights) for kind in kinds] for model in models]
    space = variants[0].space
    size = scenes[0].size
    scales = [
        shapes.nice_scale([shapes.translations(row[k], space) for row in found], 0.5 * size)
        for k in range(len(kinds))
    ]
    doubtful = any(model.ledger.status == "doubtful" for model in models)
    panels = [
        Panel(one, _shape(row[k], one, scales[k]), header if k == 0 else "")
        for one, row, header in zip(scenes, found, headers, strict=True)
        for k in range(len(kinds))
    ]
    return panels, DOUBT if doubtful else ""


def _shape(ellipsoid: Ellipsoid, where: Scene, scale: float) -> shapes.EllipsoidShape:
    if where.reference is None:
        raise MissingReferenceError(())
    reach = (2.5 if where.space is PLANAR else 0.6) * where.size
    return shapes.shape(ellipsoid, where.space, where.reference, scale, reach)


def _figure(panels: Sequence[Panel], sheet: Sheet) -> Figure:
    from vincula.view.figures import figure_of

    with drawing_settings():
        return figure_of(panels, sheet)


def need_matplotlib() -> None:
    """Refuse to draw without matplotlib.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import matplotlib as _matplotlib  # noqa: F401
    except ImportError:
        raise MissingExtraError("matplotlib", "plot", "drawing a figure") from None


@contextmanager
def drawing_settings() -> Iterator[None]:
    """Our settings while a figure is made or written, the user's before and after."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(style.RC)
        yield
