"""Bristles: friction that holds without creep and slips at Coulomb's limit."""

from dataclasses import dataclass
from typing import Final

from fakes.world.peg.attitude import Pose6, Vector3
from fakes.world.peg.contact import Contact

SHARE: Final = 0.7
"""Stiffness of a bristle against that of its contact. A bristle carries a force at rest without
creep, which friction by the speed alone would not."""
_NONE: Final = (0.0, 0.0, 0.0)

Bristles = dict[int, Vector3]
"""Deflection by slot (m)."""


@dataclass(slots=True)
class Rub:
    """Friction of one contact in a step of time.

    Its bristle is bent by the motion first, and then brought back to the length that Coulomb's
    limit allows.
    """

    deflection: Vector3
    force_n: float
    """Size of the force; it points against ``along``."""
    along: Vector3
    across: Vector3
    slips: bool
    trial_m: float


def rub(contact: Contact, kept: Bristles, moved: Pose6, friction: float) -> Rub:
    """Carry the bristle of a contact along with the motion of the peg in this step."""
    qx, qy, qz = kept.get(contact.slot, _NONE)
    lx, ly, lz = contact.lx, contact.ly, contact.lz
    qx += moved[0] + moved[4] * lz - moved[5] * ly
    qy += moved[1] + moved[5] * lx - moved[3] * lz
    qz += moved[2] + moved[3] * ly - moved[4] * lx
    nx, ny, nz = contact.nx, contact.ny, contact.nz
    into = qx * nx + qy * ny + qz * nz
    qx, qy, qz = qx - into * nx, qy - into * ny, qz - into * nz
    length: float = (qx * qx + qy * qy + qz * qz) ** 0.5
    if length > 1e-15:
        ax, ay, az = qx / length, qy / length, qz / length
    else:
        ax, ay, az = _across(nx, ny, nz)
    stiffness = SHARE * contact.stiffness_n_m
    limit_n = friction * contact.stiffness_n_m * contact.depth_m
    slips = stiffness * length > limit_n
    kept_m = limit_n / stiffness if slips else length
    across = (ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax)
    deflection = (ax * kept_m, ay * kept_m, az * kept_m)
    return Rub(deflection, stiffness * kept_m, (ax, ay, az), across, slips, length)


def _across(nx: float, ny: float, nz: float) -> Vector3:
    """Some unit vector at a right angle to a unit vector."""
    if abs(nz) < 0.9:
        length = (nx * nx + ny * ny) ** 0.5
        return -ny / length, nx / length, 0.0
    length = (ny * ny + nz * nz) ** 0.5
    return 0.0, nz / length, -ny / length
