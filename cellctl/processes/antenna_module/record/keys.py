"""Names that the record of a plugging uses; a report finds its figures by them.

They never change: stores keep runs for years, and evaluation compares runs of all of them.
"""

from cellctl.records.entries import PoseOrigin

MEASURED, COMMANDED, REPORTED = PoseOrigin.MEASURED, PoseOrigin.COMMANDED, PoseOrigin.REPORTED

REFERENCE, REFERENCE_MOVED = "reference", "reference.moved"
TRAY = "module.on_tray"
MASS = "module.mass"
PLUG, MARKS, SOCKET = "plug", "marks", "socket"
PLUG_DETAIL, SOCKET_DETAIL = "plug.measurement", "socket.measurements"
PLUG_PICTURE, SOCKET_PICTURE = "plug.png", "socket.png"
TAUGHT_PICTURE = "taught-plugs.png"
GRIP_OFFSET, GRIP_TURN = "grip.offset", "grip.turn"
REGRIPS, REGRIP = "grip.again", "regrip"
SECOND_LOOKS, SECOND_LOOK = "look.again", "second_look"
PLAN, TARGET = "plan", "target"
WORST_CONTACT = "plan.worst_contact_p99"
INSERTION, CURVE = "insertion", "insertion.csv"
SEAT_DEPTH, PEAK, TOTAL = "insertion.seat_depth", "insertion.peak", "insertion.total"
SIDE, MOMENT_Z = "insertion.side", "insertion.moment_z"
PULL, PULL_TRAVEL = "verify.pull", "verify.pull_travel"
PLACED, PLACED_TURN, GAP = "verify.offset", "verify.turn", "verify.gap"
