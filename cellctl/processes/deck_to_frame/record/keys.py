"""Names that the record of an assembly uses; a report finds its figures by them.

They never change: stores keep runs for years, and evaluation compares runs of all of them.
"""

BASE, FLANGE, HEAD_1, FRAME, DECK = "base", "flange", "c1", "frame", "deck"
"""Frames of the recorded poses."""
FLANGE_T_DECK = "flange_T_deck"

LOOP, SEATED = "pose correction", "seated"
FITTED = ("frame", "deck", LOOP, SEATED)
"""What is registered with its drawing in every assembly."""
COMPONENTS = (
    ("X", "mm"), ("Y", "mm"), ("Z", "mm"),
    ("rx", "°"), ("ry", "°"), ("rz", "°"),
)  # fmt: skip
"""Name and unit of the components of one pass, of the error in the axes of the frame."""

MEASURED_FROM = "measurements.input"
"""Document: for each measurement the images and the prediction that it was computed from."""

FAILED = "failed"
"""Key in that document of a measurement that ended with a fault, and what its images begin with."""

MATING = "mating"
"""Document with what is no number."""
TARGET_FORCE, LIMIT_FORCE, PEAK_FORCE = "target_force", "limit_force", "peak_force"
POSITION_ERROR, ANGLE_ERROR = "position_error", "angle_error"
PIN_OFFSETS = "pin_offsets"
GAP_BY_VISION, SEAT_ROTATION = "seat_gap_by_vision", "seat_rotation"
SEATED_ERROR, SEATED_SIGMA = "seated_error", "seated_sigma"
FORCE_WHILE_VERIFIED = "force_while_verified"
UNCERTAINTY = "uncertainty"
"""Ends the key of the expanded uncertainty of a figure (docs/decisions/0016)."""
WORST_RESIDUAL = "worst_residual"
