"""Whether an arm that presses on something may leave it by itself, and how hard it presses."""

from dataclasses import replace

from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.cell.guarded_motion.kept_zero import kept_zero, newest_samples, pressed_since
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.errors.force import LiftOffHeld
from cellctl.interfaces import Robot

_LEAST_PULL_N = 5.0
"""A smaller pull cannot be watched: noise of a reading, or the pull of a hose over the first
millimetre, would look the same."""


def able_to_leave(robot: Robot, guard: GuardPort) -> bool:
    """The robot lacks nothing but the release of its latch, the guard could stop it again."""
    state, health = robot.state(), guard.health()
    # The latch is what the stop has just set and what rearming will release; everything else that
    # makes a robot not ready needs a person.
    able = replace(state, stop_latched=False).ready
    return able and health.alive and health.stop_channel_up


async def pressed_n(arm: GuardedRobot, inwards: float, most_n: float) -> float:
    """Force in N with which a part is pressed into its place; negative where the part is pulled.

    Ask before a tare, which hides this force. When the part is drawn out, the force changes by this
    much before the part is pulled at all. What an earlier tare has hidden is counted in.

    ``inwards`` is 1 where z of the guard's frame points into the place and -1 where it points out.
    A guard that has no frame of the part, or no zero that was taken in it, does not know: guard or
    daemon may have been started anew. Then the zero that was kept on the disk counts. The answer is
    at most ``most_n``, and it is ``most_n`` without such a zero or without a sample.
    """
    guard = arm.guard
    hidden_n = guard.hidden_axial_n
    if not guard.in_part_frame or hidden_n is None:
        kept = await kept_zero(arm)
        known_n = None if kept is None else await pressed_since(arm, kept)
        return most_n if known_n is None else min(most_n, known_n)
    wrench = (await newest_samples(guard)).wrench
    if not len(wrench):
        return most_n
    return min(most_n, -inwards * (hidden_n + float(wrench[:, 2].mean())))


def change_while_drawn_n(pull_n: float, press_n: float) -> float:
    """Change of the force (N) from a part that is pressed to one that is pulled with ``pull_n``.

    For a part that is pulled already, less is left. Raises ``LiftOffHeld`` where nothing is left:
    each new attempt begins from a zero of its own, and would otherwise pull harder than the last.
    """
    if pull_n + press_n < _LEAST_PULL_N:
        raise LiftOffHeld(f"it is pulled with {-press_n:.0f} N already, allowed {pull_n:.0f} N")
    return pull_n + press_n
