"""The move out of a contact: so slow at first that a part which is held is noticed in time."""

FIRST_LIFT_M = 4e-4
"""A part that is held is noticed within it, unless arm and grip are softer than 125 N/mm."""


def leaving_speed_m_s(
    limit_n: float, stiffness_n_m: float, delay_s: float, greatest_m_s: float
) -> float:
    """So slow that a part that is held is pulled by no more than twice the limit.

    The guard stops at the limit. Until the arm stands, ``delay_s`` later, the pull grows at the
    rate k v, by no more than the limit again.
    """
    return min(limit_n / delay_s / stiffness_n_m, greatest_m_s)
