"""The move out of a contact: so slow at first that a part which is held is noticed in time."""

FIRST_LIFT_M = 4e-4
"""Length of the first, slowest stretch. A part that is held is noticed within it, unless arm and
grip together are softer than 125 N/mm: at that stiffness 0.4 mm make 50 N, the usual limit."""


def leaving_speed_m_s(
    limit_n: float, stiffness_n_m: float, delay_s: float, greatest_m_s: float
) -> float:
    """Speed (m/s) at which a part that is held is pulled by no more than twice ``limit_n``.

    The guard stops at the limit. Until the arm stands, ``delay_s`` later, the pull goes on growing
    at the rate k v, here by no more than the limit once more: k v T = F_limit.
    """
    return min(limit_n / delay_s / stiffness_n_m, greatest_m_s)
