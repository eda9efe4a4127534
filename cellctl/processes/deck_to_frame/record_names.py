"""Names of this process's calibrations that are read without their solvers."""

BOARD_TRANSFER_NAME = "board_transfer"
PAYLOAD_NAME = "payload"
STOP_LATENCY_NAME = "stop_latency"
CONTACT_STIFFNESS_NAME = "contact_stiffness"
HEAD_JOINTS = "head_joints_deg"
"""Key of the board transfer's record: taught joints of each head's robot, by head."""
