"""Names of the independent reference cases on MJCF robots, and their words for contacts."""

from __future__ import annotations

GRASPS = (
    "aloha_dualarm_complete",
    "aloha_dualarm_complete_right_wrist_passive",
    "aloha_dualarm_hard",
    "leap_4finger_hard",
    "leap_4finger_soft",
    "robotiq2f85_grasp_driver0p4_parallel_complete",
    "robotiq2f85_grasp_driver0p4_parallel_hard",
)
"""Those with a grasped object."""

CASES = (
    *GRASPS,
    "robotiq2f85_pad_driver0p4_parallel_springs_locked",
    "robotiq2f85_pad_home_springs_locked",
    "robotiq2f85_pad_home_underactuated",
    "stewart_sdf_generic",
    "stewart_sdf_generic_8_actuated",
    "stewart_sdf_home",
)
CONTACTS = {"hard": "hard-finger", "soft": "soft-finger", "complete": "complete"}
