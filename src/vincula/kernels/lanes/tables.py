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

HEADER: Final = 64
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

# The plan: how passive joints are eliminated and the relation is built, see `plan`
FRONTS: Final = 32
"""Number of fronts."""
FRONT: Final = 33
"""Fronts of `FRONT_ENTRY` entries each, children before parents."""
LIMBS: Final = 34
"""Number of limbs."""
LIMB: Final = 35
"""Limbs of `LIMB_ENTRY` entries each."""
BUFFER: Final = 36
"""Slot of the matrix that is being eliminated."""
FACTORS: Final = 37
"""Slot of the factors of its reflections, three each."""
VECTOR: Final = 38
"""Slot of a vector as long as any side of any matrix."""
STACK: Final = 39
"""Slot of a matrix of d columns, one row a reduced row."""
BASIS: Final = 40
"""Slot of U, d rows of at most `WIDEST` entries: twists in terms of the motions left so far."""
WIDEST: Final = 41
"""Most motions left at any time."""
MOTIONS: Final = 42
"""Slot of the motions (q_a, u), n_a + d entries each, orthonormal in the metrics."""
SQUARES: Final = 43
"""Slot of two squared lengths a motion."""
FREEDOM: Final = 44
"""Number of motions k."""
FREE: Final = 45
"""How many of them the motors do not drive: infinite efficiencies."""
IDLE: Final = 46
"""How many of them leave the member at rest: efficiencies zero."""
METRIC: Final = 47
"""Constants: n_a + d factors from lengths in the metrics to scaled rates and twists, then as many for the
results that are motions, and for those that are efforts."""
REDUCED: Final = 48
"""Number of reduced rows M."""
OBJECT_RANK: Final = 49
"""Rank of the twist columns of the reduced rows."""
OBJECT_ORDER: Final = 50
"""Order of those columns, independent ones first."""
REST_ROWS: Final = 51
"""Rows left by motors when twists come after them."""
REST_RANK: Final = 52
"""Their rank."""
REST_ORDER: Final = 53
"""Order of their columns."""
NOTES: Final = 54
"""Slot of what is noted on the way: see the names below."""
DOUBT: Final = 55
"""Constants: rounding, digits and tolerance together; rounding alone; factor from residual to rho."""
OUTPUT: Final = 56
"""Slot of the results."""
TOTAL: Final = 57
"""Slots altogether, without those for the twelve counts."""
WHOLE: Final = 58
"""Slot of the whole matrix A, then of the one whose rank is asked for."""
WHOLE_FACTORS: Final = 59
"""Slot of its factors and of a vector."""
EVERY_COLUMN: Final = 60
"""A list of all joint columns."""
RANKS: Final = 61
"""Entries for J_a, G^T, [J_a G^T] and the test matrix: rows, rank, columns (number), order (place), then the
columns."""
RANK_SPACE: Final = 62
"""Length of such an entry."""
TOTAL_WITH_COUNTS: Final = 63
"""Slots altogether."""

# Notes, slots from `NOTES` on
NORM: Final = 0
"""Squared norm of A."""
TRAIL: Final = 1
"""Largest squared norm of what should be zero by the ranks of the plan."""
PASSIVE_INVERSE: Final = 2
"""Largest squared norm of an inverse: passive columns of one limb."""
DRIVEN_INVERSE: Final = 3
"""The same for passive and active columns of one limb."""
OBJECT_INVERSE: Final = 4
"""For the twist columns of the reduced rows."""
REST_INVERSE: Final = 5
"""For the twist columns of the rows that motors leave."""
RESIDUAL: Final = 6
"""Squared largest gap."""
LIMB_INVERSE: Final = 7
"""Squared norm of the inverse so far in the limb at hand."""
DRIVEN_COUPLING: Final = 8
"""Sum over limbs of the squared norm of R^-1 B on the twist, R the motors' columns of the reduced rows."""
REACHED: Final = 9
"""Squared distance of the farthest joint from the reference point."""
MOTOR_COUPLING: Final = 10
"""Largest squared norm, over limbs, of R^-1 B for the motors' columns B."""
OBJECT_COUPLING: Final = 11
"""Sum over limbs of the same on the twist."""
LIMB_COUPLING: Final = 12
"""That on the motors so far in the limb at hand."""
CHANGED: Final = 13
"""Last round of rotations in which something changed."""
NOTE_COUNT: Final = 14

# A front: rows, pivots, their rank, other columns, rows handed on, mode, member, slot of what is handed on
# (row after row), blocks (place, number), columns (place), children (place, number), order (place),
# reflections, limb; then of limbs with several fronts: slot of inverses (-1 in the others), passive columns
# among the others (number, place: position here, index in the next front or -1), next front (-1 for the
# last), motors and twist components (number of both, place of their positions here or -1)
FRONT_ENTRY: Final = 22
BY_LEFT: Final = 0
"""Rows handed on are products with left null vectors."""
BY_REFLECTION: Final = 1
"""Rows handed on are reflected until they are triangular; what is below is zero."""

# A limb: slot of its reduced rows, their number, motors (number, place), rank of the motors' columns, order
# of those columns, rank against the limbs before, order of its rows, slot of its reflections, motions before
LIMB_ENTRY: Final = 10
