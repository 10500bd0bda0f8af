"""A mechanism as two flat arrays: whole numbers (`code`) and doubles (`constants`).

`code` begins with the entries named here: sizes, and where in `code` a table begins.  All lengths in
`constants` are in units of the characteristic length, so every kernel works in scaled units (numerics
page, step 1).  A slot is a place in the workspace; a frame takes 12, its rotation row by row, then its
origin.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Code = NDArray[np.int64]
"""A mechanism as whole numbers."""

HEADER: Final = 32
"""Entries before the first table."""

# Sizes
VALUES: Final = 0
"""Number of configuration values."""
TAPE_LENGTH: Final = 1
"""Number of instructions that place frames."""
BLOCKS: Final = 2
"""Number of row blocks: parts whose rows share signs, a coupling or a drive being a block of one row."""
COLUMNS: Final = 3
"""Number of columns (q_a, q_p)."""
MOTORS: Final = 4
"""Number of motors n_a; they are the first columns."""
ROWS: Final = 5
"""Number of rows m."""
TWIST: Final = 6
"""Number of twist components d: 3 or 6."""
BODY_AXES: Final = 7
"""1 where twists are written in the axes of the member."""
SLOTS: Final = 8
"""Slots used up to and including the frames and directions."""

# Places in the workspace
VALUE_SLOT: Final = 9
"""First slot of the configuration values (scaled)."""
REFERENCE: Final = 10
"""Slot of the frame at the reference point, axes of the member."""
SCRATCH: Final = 11
"""24 slots that any kernel may use and leave behind."""

# Where tables begin in `code`
TAPE: Final = 12
"""Instructions of `INSTRUCTION` entries each."""
VALUE_SCALE: Final = 13
"""For every value the constant that it is multiplied by, or -1."""
BLOCK: Final = 14
"""Row blocks of `BLOCK_ENTRY` entries each."""
ROW: Final = 15
"""Rows of `ROW_ENTRY` entries each."""
COLUMN: Final = 16
"""Columns of `COLUMN_ENTRY` entries each."""
SIGN: Final = 17
"""Row blocks x columns: -1, 0, 1; for blocks of couplings the constant or slot, see `rows`."""
DIRECTIONS: Final = 18
"""Instructions that make directions of general rows and columns; number first."""
POLYNOMIAL: Final = 19
"""Polynomial couplings, number first: slope slot, terms (value, constant), derivative (length, constant)."""
GAPS: Final = 20
"""Parts outside the kinematic tree, whose gaps say how far loops are open; number first."""
REACH: Final = 21
"""Frames at the joints, for the size of the mechanism; number first."""

# An instruction: operation, target slot, source slot (-1 the ground), constant, value slot, sign, flags, axis
INSTRUCTION: Final = 8
PLACE: Final = 0
"""Target = source times a constant pose; flags: 1 has a rotation, 2 has a position."""
TURN: Final = 1
"""Turn about the target's own z."""
SLIDE: Final = 2
"""Slide along the target's own axis."""
HELIX: Final = 3
"""Turn about z and advance by constant times the angle."""
TURN_ABOUT: Final = 4
"""Turn about a constant axis of the target."""
BALL: Final = 5
"""Turn by a quaternion (w, x, y, z), sign -1 for its inverse."""

# A row block: first row, rows, slot of the point, carried, kind
BLOCK_ENTRY: Final = 5
GEOMETRY: Final = 0
"""Rows from a joint or contact."""
LINEAR: Final = 1
"""A row of constant coefficients."""
CURVED: Final = 2
"""A row of a polynomial coupling."""

# A row: kind, frame slot or direction slot, axis
ROW_ENTRY: Final = 3
PUSH_GROUND: Final = 0
TURN_GROUND: Final = 1
PUSH_FRAME: Final = 2
TURN_FRAME: Final = 3
GENERAL: Final = 4
"""Push and turn from six direction slots."""

# A column: frame slot, centre slot, axis (0-2 of the frame, -1 direction slot), turn, slide (-1 none, -2 one,
# else a constant)
COLUMN_ENTRY: Final = 5

# A direction: kind, first slot, frame slot, constant, other frame slot
DIRECTION_ENTRY: Final = 5
FIXED_DIRECTION: Final = 0
"""A constant vector turned with a frame."""
COMMON_NORMAL: Final = 1
"""Unit vector perpendicular to z of a frame and to a constant vector of another."""
FIXED_ROW: Final = 2
"""Push and turn, two constant vectors turned with a frame."""

# A gap: kind, frame of A, frame of B, components in the axes of A (a bit each), constant
GAP_ENTRY: Final = 5
WHOLE_POSE: Final = 0
"""The two frames should coincide."""
TURNED: Final = 1
"""Of the offset and of the rotation vector the components named should vanish."""
TILTED: Final = 2
"""The offset's components, and the tilt between the two z axes."""
BEYOND: Final = 3
"""The offset's components, and the angle of z to an axis of B; constants: axis, cosine, 1 / sine."""
BALANCE: Final = 4
"""A coupling: entries are where its terms are in `code`, and the constant that scales its residual."""
