"""The deck on the flange of the main robot, before every assembly (section 2.1.3, eq. 4)."""

from cellctl.geometry.uncertain import UncertainPose


def deck_on_flange(
    base_T_flange: UncertainPose, base_T_c1: UncertainPose, c1_T_deck: UncertainPose
) -> UncertainPose:
    """Equation 4: F_T_D = (B_T_F)^-1 · B_T_C1 · C1_T_D.

    ``base_T_flange`` is the reported pose while the deck was measured, with the robot's own
    uncertainty as covariance.
    """
    return base_T_flange.inv() * (base_T_c1 * c1_T_deck)
