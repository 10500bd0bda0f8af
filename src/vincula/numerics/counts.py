"""Integer bookkeeping: from ranks to the twelve counts and the summary counts.

Source: theory page, section 3 (three subspaces and three kernels; a representation of the D4 quiver).
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Ranks:
    """The ranks of J_a, J_p, G^T, their stacks, and [[J_a J_p 0] [J_a 0 G^T]]."""

    active: int
    passive: int
    member: int
    active_passive: int
    active_member: int
    passive_member: int
    all: int
    triple: int


@dataclass(frozen=True, slots=True)
class TwelveCounts:
    """Dimensions of the twelve indecomposable parts of a constrained mechanism.

    Attributes:
        ar: Active redundancy, dim ker J_a.
        pr: Passive redundancy, dim ker J_p.
        oi: Indeterminate object, dim ker G^T.
        t: Directions in all three ranges.
        ap: Active and passive coordinated, object locked.
        ao: Active and object coordinated, passive joints locked.
        po: Passive joints and object, motors locked.
        g: All three must move.
        a: Directions that only motors reach: internal torques.
        p: Directions that only passive joints reach.
        o: Directions that only the object reaches: structural wrenches.
        none: Directions that nothing reaches: static indeterminacy.
    """

    ar: int
    pr: int
    oi: int
    t: int
    ap: int
    ao: int
    po: int
    g: int
    a: int
    p: int
    o: int
    none: int

    @staticmethod
    def from_ranks(rows: int, n_a: int, n_p: int, n_o: int, ranks: Ranks) -> TwelveCounts:
        """The counts of a mechanism with `rows` constraints and n_a, n_p, n_o columns.

        Integer arithmetic only: contradictory ranks give negative entries (`contradictory`).
        """
        r_a, r_p, r_o = ranks.active, ranks.passive, ranks.member
        ar, pr, oi = n_a - r_a, n_p - r_p, n_o - r_o
        t = n_a + n_p + n_o - ranks.triple - ar - pr - oi
        ap_range = r_a + r_p - ranks.active_passive
        ao_range = r_a + r_o - ranks.active_member
        po_range = r_p + r_o - ranks.passive_member
        coordinated = r_a + ranks.passive_member - ranks.all
        ap, ao, po = ap_range - t, ao_range - t, po_range - t
        g = coordinated - ap_range - ao_range + t
        return TwelveCounts(
            ar=ar, pr=pr, oi=oi, t=t, ap=ap, ao=ao, po=po, g=g,
            a=r_a - ap - ao - t - g,
            p=r_p - ap - po - t - g,
            o=r_o - ao - po - t - g,
            none=rows - ranks.all,
        )  # fmt: skip

    @property
    def nullity(self) -> int:
        """Dimension of all feasible motions: the kernel of (1)."""
        return self.ar + self.pr + self.oi + 2 * self.t + self.ap + self.ao + self.po + self.g

    @property
    def contradictory(self) -> tuple[str, ...]:
        """Names of negative entries: the ranks they come from contradict each other."""
        return tuple(name for name, value in self.as_dict().items() if value < 0)

    def as_dict(self) -> dict[str, int]:
        """The counts by name."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}


@dataclass(frozen=True, slots=True)
class SummaryCounts:
    """Mobility and the seven numbers that do not depend on where the graph was cut.

    Attributes:
        mobility: Dimension of all feasible motions (nullity of (1)).
        passive_redundancy: Motions of passive joints alone.
        redundancy: Motor motions that leave the member at rest (zero kinematic efficiencies).
        indeterminacy: Member motions with all motors locked (infinite kinematic efficiencies).
        coordinated: Member motions that the motors drive (finite efficiencies).
        internal_torques: Motor torques balanced without external wrench.
        structural_wrenches: Wrenches carried without motor torque.
        static_indeterminacy: Constraint forces that neither wrench nor torque determines.
    """

    mobility: int
    passive_redundancy: int
    redundancy: int
    indeterminacy: int
    coordinated: int
    internal_torques: int
    structural_wrenches: int
    static_indeterminacy: int

    @staticmethod
    def from_ranks(
        rows: int, n_a: int, n_p: int, n_o: int, r_p: int, r_ap: int, r_po: int, r_apo: int
    ) -> SummaryCounts:
        """The summary from the ranks of J_p, [J_a J_p], [J_p G^T] and [J_a J_p G^T]."""
        return SummaryCounts(
            mobility=n_a + n_p + n_o - r_apo,
            passive_redundancy=n_p - r_p,
            redundancy=n_a + r_p - r_ap,
            indeterminacy=n_o + r_p - r_po,
            coordinated=r_ap + r_po - r_p - r_apo,
            internal_torques=r_apo - r_po,
            structural_wrenches=r_apo - r_ap,
            static_indeterminacy=rows - r_apo,
        )

    def as_dict(self) -> dict[str, int]:
        """The counts by name."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}
