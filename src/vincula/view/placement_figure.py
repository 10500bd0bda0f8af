"""The figure of a placement: the best choices as bars, and the Pareto front of those that hold the member."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.analysis.ranking import CRITERIA
from vincula.design.motor_choice import MotorChoice
from vincula.design.placement import LESS_IS_BETTER, Placement
from vincula.view import layout, style
from vincula.view.plot import drawing_settings, need_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BARS: Final = 16
"""Choices with a bar of their own."""
NAMED: Final = 10
"""Choices of the front with their motors beside them."""
MARKERS: Final = ("o", "s", "^", "D", "v", "P", "X")
"""Symbols by number of motors, the last one for all larger numbers."""
GREY: Final = "#9a9a9a"


def plot_placement(placement: Placement, *, width: float | None = None) -> Figure:
    """A ranking of motor choices as a figure for print.

    Left the best choices by what they are ranked by: the bar is the worst value over the configurations, the
    tick the mean.  Right all choices that control the member over the first two criteria of the Pareto front
    (the worst values), symbols by number of motors, the front in colour and named.  Where no choice controls
    the member: the nearest ones, and how many motions choices of every size leave to it.

    Args:
        placement: The ranking.
        width: Width of the figure [inch].

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    need_matplotlib()
    with drawing_settings():
        return _figure(placement, width or layout.PAGE)


def _figure(placement: Placement, paper: float) -> Figure:
    from matplotlib.figure import Figure

    able = placement.controlling
    ranked = [choice for choice in able or placement.choices if choice.index is not None or not able][:BARS]
    tall = max(2.6, 0.55 + 0.19 * max(len(ranked), 4))
    figure = Figure(figsize=(paper, tall))
    names = max((len(_short(placement, choice)) for choice in ranked), default=4)
    left = min(0.28, (0.25 + 0.055 * min(names, 40)) / paper)
    bars = figure.add_axes((left, 0.42 / tall, 0.5 - left - 0.02, 1.0 - 0.75 / tall))
    _bars(bars, placement, ranked)
    cloud = figure.add_axes((0.5 + 0.62 / paper, 0.42 / tall, 0.48 - 0.62 / paper, 1.0 - 0.75 / tall))
    if able:
        _cloud(cloud, placement)
    else:
        _motions_left(cloud, placement)
    return figure


def _bars(axes: Axes, placement: Placement, ranked: list[MotorChoice]) -> None:
    """One bar a choice, best on top."""
    front = {id(choice) for choice in placement.front}
    blue = style.KINDS["kinematic"].colour
    for k, choice in enumerate(ranked):
        worst, mean = _bounded(choice.index), _bounded(choice.mean)
        axes.barh(-k, worst, height=0.66, color=blue if id(choice) in front else GREY, linewidth=0.0)
        if len(choice.counts) > 1:
            axes.plot([mean, mean], [-k - 0.36, -k + 0.36], color=style.INK, linewidth=1.0)
    axes.set_yticks([-k for k in range(len(ranked))], [_short(placement, choice) for choice in ranked])
    axes.tick_params(axis="y", length=0.0)
    axes.set_ylim(-max(len(ranked), 4) + 0.4, 0.6)
    axes.set_xlabel(f"{placement.rank_by} index", labelpad=2)
    several = len(placement.looked.models) > 1
    lead = "best choices" if placement.controlling else "no choice controls the member: nearest"
    axes.set_title(lead + (": worst (bar) and mean (tick)" if several else ""), pad=4)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _cloud(axes: Axes, placement: Placement) -> None:
    """All choices that control the member over two criteria."""
    names = (
        *placement.front_criteria,
        *(n for n in ("active-force", "kinematic") if n not in placement.front_criteria),
    )
    first, second = names[:2]
    front = {id(choice) for choice in placement.front}
    points = [(choice, _number(choice, first), _number(choice, second)) for choice in placement.controlling]
    known = [point for point in points if np.isfinite(point[1:]).all()]
    sizes = placement.admissible.sizes
    for number, size in enumerate(sizes):
        look: dict[str, Any] = {"marker": MARKERS[min(number, len(MARKERS) - 1)], "linestyle": "none"}
        for on_front, colour, edge, scale in ((False, "white", GREY, 3.5), (True, "#D55E00", style.INK, 5.0)):
            group = [p for p in known if len(p[0].motors) == size and (id(p[0]) in front) == on_front]
            if group:
                label = f"{size} motor{'' if size == 1 else 's'}{', on the front' if on_front else ''}"
                axes.plot(
                    [p[1] for p in group], [p[2] for p in group], markersize=scale, markerfacecolor=colour,
                    markeredgecolor=edge, markeredgewidth=0.6, label=label, **look,
                )  # fmt: skip
    named = [p for p in known if id(p[0]) in front][:NAMED]
    for choice, x, y in named:
        axes.annotate(
            _short(placement, choice), (x, y), xytext=(4, 3), textcoords="offset points", fontsize=5.5
        )
    axes.set_xlabel(_label(first), labelpad=2)
    axes.set_ylabel(_label(second), labelpad=2)
    axes.margins(x=0.16, y=0.1)
    axes.set_title("Pareto front of " + ", ".join(placement.front_criteria), pad=4)
    if known:
        axes.legend(fontsize=5.5, frameon=False, loc="best", handletextpad=0.2)


def _motions_left(axes: Axes, placement: Placement) -> None:
    """Motions that choices leave to the member, by number of motors: a disc as large as their share."""
    sizes = placement.admissible.sizes
    for size in sizes:
        left = [choice.largest("indeterminacy") for choice in placement.choices if len(choice.motors) == size]
        for motions in sorted(set(left)):
            share = left.count(motions) / len(left)
            axes.plot(size, motions, "o", color=GREY, markersize=3.0 + 12.0 * share**0.5)
            axes.annotate(
                str(left.count(motions)), (size, motions), xytext=(9, 0), textcoords="offset points",
                fontsize=5.5, va="center",
            )  # fmt: skip
    axes.set_xticks(sizes)
    axes.set_yticks(range(placement.fewest + 1))
    axes.set_xlim(sizes[0] - 0.6, sizes[-1] + 0.6)
    axes.set_ylim(-0.4, placement.fewest + 0.4)
    axes.set_xlabel("motors", labelpad=2)
    axes.set_ylabel("motions left with motors locked", labelpad=2)
    axes.set_title("how many choices leave how many motions", pad=4)


def _label(criterion: str) -> str:
    words = criterion if criterion in LESS_IS_BETTER else f"{criterion} index"
    return f"{words} (less is better)" if criterion in LESS_IS_BETTER or criterion not in CRITERIA else words


def _number(choice: MotorChoice, criterion: str) -> float:
    if criterion == "cost":
        return choice.cost
    if criterion == "motors":
        return float(len(choice.motors))
    worst = choice.indices[criterion].worst if criterion in choice.indices else None
    return float("nan") if worst is None else worst


def _bounded(value: float | None) -> float:
    return 0.0 if value is None or not np.isfinite(value) else value


def _short(placement: Placement, choice: MotorChoice, most: int = 40) -> str:
    """The motors of a choice, without the ending that all candidates share (`_joint`)."""
    ending = _ending(placement.admissible.candidates)
    text = ", ".join(name.removesuffix(ending) if ending else name for name in choice.motors)
    return text if len(text) <= most else f"{text[: most - 1]}…"


def _ending(names: Sequence[str]) -> str:
    """What all names end with, from a separator on; empty where nothing would be left of one."""
    if len(names) < 2:
        return ""
    shortest = min(names, key=len)
    same = (shortest[k:] for k in range(len(shortest)))
    ending = next((text for text in same if all(name.endswith(text) for name in names)), "")
    starts = [ending.find(mark) for mark in "_-./" if mark in ending]
    ending = ending[min(starts) :] if starts else ""
    return "" if any(name == ending for name in names) else ending
