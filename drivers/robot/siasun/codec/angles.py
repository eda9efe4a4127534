"""The order in which a controller writes its angles, as its hello names it; without arrays, because
the guard reads poses too.

A record holds a, b and c in degrees: what the controller writes about z, y and x, in this order.
"""

import math

from cellctl.geometry.euler_order import EulerOrder, Rows

EULER_ORDERS = {
    "ZYX": EulerOrder.FIXED_XYZ,
    "XYZ": EulerOrder.MOVING_XYZ,
    "ROTVEC": EulerOrder.ROTATION_VECTOR,
}
"""Orders of angles by their word in the hello (docs/protocols/sjl-1.md, section 2)."""


def rotation_rows(order: EulerOrder, a_deg: float, b_deg: float, c_deg: float) -> Rows:
    """The rotation matrix of three angles of a record, row by row."""
    return order.rows(math.radians(c_deg), math.radians(b_deg), math.radians(a_deg))
