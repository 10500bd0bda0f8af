"""What was assumed, proved or read otherwise, in words: the rest of what is said about doubt.

Source: numerics page, "What a result says".
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from vincula.model import LinearModel
from vincula.numerics.counts import SummaryCounts
from vincula.numerics.evidence import NO_EVIDENCE, NearestSingular

_MOST: Final = 4
"""Numbers that are named one by one."""


def reading_message(model: LinearModel) -> str | None:
    """Both readings of numbers that may mean others; None where the counts are the same in both."""
    reading = model.evidence.reading
    if reading is None or reading.summary is None:
        return None
    typed = as_typed(model)
    if typed == reading.summary:
        return None
    numbers = _listed(reading.snapped)
    return (
        f"{_differences(typed, reading.summary)} if {numbers}.  To decide: --snap reads the numbers so, "
        "--exact takes them as typed; or type all digits of what is meant."
    )


def as_typed(model: LinearModel) -> SummaryCounts:
    """The summary counts with every typed number taken for what it is."""
    known = replace(model.uncertainty, digits_length=0.0, digits_angle=0.0)
    return replace(model, uncertainty=known, evidence=NO_EVIDENCE).ledger.summary


def settled_messages(model: LinearModel) -> list[str]:
    """What was assumed, and proofs that go against what the margins say."""
    ledger = model.ledger
    said = []
    for name in ledger.names:
        if not ledger.decided(name):
            continue
        decision = ledger.decision(name)
        if decision.proof == "assumed":
            zeros = ", ".join(f"{v:.2g}" for v in decision.singular_values[decision.rank : decision.rank_max])
            said.append(
                f"Rank of the {decision.name} is taken as {decision.rank}: the singular values {zeros} were "
                "assumed to be zero (--assume-singular), which nothing proves."
            )
        elif decision.proof == "exact" and decision.status == "exact":
            dropped = decision.singular_values[decision.rank :]
            by_margins = int((decision.singular_values > decision.cutoff).sum())
            if by_margins != decision.rank:
                what = "kept" if decision.rank > by_margins else "zero"
                smallest = decision.kept if decision.rank > by_margins else float(dropped[0])
                said.append(
                    f"Rank of the {decision.name} is exactly {decision.rank}, by the margins it would be "
                    f"{by_margins}: the singular value {smallest:.2g} is {what} as the numbers are written."
                )
    return said


def nearest_words(found: NearestSingular) -> str:
    """The nearest singular configuration in words."""
    axis, moved = found.largest
    shares = ", ".join(f"{joint} {share:.2f}" for joint, share in list(found.joints.items())[:_MOST])
    proved = "proved to be near" if found.kantorovich < 0.5 else "not proved"
    return (
        f"Nearest singular configuration: {found.distance:.2g} away (radians and lengths L; most by {axis}, "
        f"{moved:.2g}), residual {found.residual:.1g}, Kantorovich number {found.kantorovich:.1g} "
        f"({proved}); there {shares} move."
    )


def _listed(numbers: tuple[str, ...]) -> str:
    more = f"; and {len(numbers) - _MOST} more" if len(numbers) > _MOST else ""
    return "; ".join(numbers[:_MOST]) + more


def _differences(typed: SummaryCounts, other: SummaryCounts) -> str:
    """`mobility is 0 with the numbers as typed, 1`, and whatever else differs."""
    ours, theirs = typed.as_dict(), other.as_dict()
    differing = [name for name in ours if ours[name] != theirs[name]]
    first = differing[0]
    words = [
        f"{first.replace('_', ' ').capitalize()} is {ours[first]} with the numbers as typed, {theirs[first]}"
    ]
    words += [f"{name.replace('_', ' ')} {ours[name]}, {theirs[name]}" for name in differing[1:3]]
    return f"{words[0]} ({'; '.join(words[1:])})" if words[1:] else words[0]
