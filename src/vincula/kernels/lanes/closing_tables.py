"""A mechanism's closing as a flat array of whole numbers, `plan`, beside `code` (values and frames).

`plan` begins with the entries named here: sizes, places in the workspace, and where in `plan` a table
begins.
"""

from __future__ import annotations

from typing import Final

HEADER: Final = 32
"""Entries before the first table."""

# Sizes
UNKNOWNS: Final = 0
"""Number of unknown rates."""
BLOCKS: Final = 1
"""Number of parts with gaps."""
EQUATIONS: Final = 2
"""Number of gaps."""
INPUTS: Final = 3
"""Numbers given for one configuration."""
ENTRIES: Final = 4
"""Entries of the normal matrix and its factor."""
SLOTS: Final = 5
"""Slots of the workspace in all."""
ANCHOR: Final = 23
"""Slots of the values, and of what was given, where a walk sets out."""
STATE_VALUES: Final = 22
"""Number of configuration values."""
POSE: Final = 6
"""Slot of the reference member's frame where its pose is given, else -1."""

# Places in the workspace
INPUT: Final = 7
"""Slots of what is asked for, scaled."""
GAP: Final = 8
"""Slots of the gaps."""
NORMAL: Final = 9
"""Slots of the normal matrix."""
STEP: Final = 10
"""Slots of its right-hand side, then of the step."""
STATE: Final = 11
"""Slots that walking keeps: values last closed, their last way, what was given there, its last way, what is
asked for."""
SIDE: Final = 12
"""Slot of the smallest cosine that tells a gap of zero from half a turn."""

# Where tables begin
COLUMN: Final = 13
"""Unknowns, `COLUMN_ENTRY` each, in the order of elimination."""
BLOCK: Final = 14
"""Parts with gaps, `BLOCK_ENTRY` each."""
DIRECTION: Final = 15
"""Constant axes to turn with a frame: number, then target slot, frame slot, constant."""
FACTOR: Final = 16
"""For every unknown: entry of its diagonal, number below, their places, then entries that they change; where
the parts of the unknowns begin stands just before."""
UPDATE: Final = 17
"""Values that change: number, then kind, value slot, unknown(s)."""
HELD: Final = 18
"""Values that are given: number, then value slot, input."""
SCALAR: Final = 19
"""Couplings and drives: number, then one after the other (see `closing_scalars`)."""
MEASURED: Final = 20
"""Values read off at the end: number, then kind, value slot, frame A, frame B."""
QUATERNIONS: Final = 21
"""First value slots of all quaternions; number first."""

# An unknown: frame slot (or direction slot), axis (0-2, -1 a direction), centre slot, turn, slide
# (-1 none, -2 one, else a constant)
COLUMN_ENTRY: Final = 5

# A part: frames A and B, components of the offset (a bit each, 8: all, in ground axes), how turns are
# measured, their components, constant, first gap, number of gaps, slot of turned rows, where its unknowns are
# in `plan` (unknown and sign, then entries of the normal matrix), their number, slot of its Jacobian
BLOCK_ENTRY: Final = 12
ALL: Final = 8
FREE: Final = 0
"""Turns are free."""
WHOLE: Final = 1
"""All three, in ground axes."""
VECTOR: Final = 2
"""Components of the rotation vector, axes of A."""
TILT: Final = 3
"""z of B against z of A."""
BETWEEN: Final = 4
"""The angle from z of A to an axis of B; its drawn cosine follows the axis among the constants."""

# An update
NUMBER: Final = 0
BALL: Final = 1

# A measurement
TURN: Final = 0
"""The quaternion alone."""
PLACE: Final = 1
"""Position, then the quaternion."""
