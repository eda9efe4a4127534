"""Whether an arm that presses on something may leave it by itself."""

from dataclasses import replace

from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.interfaces import Robot


def able_to_leave(robot: Robot, guard: GuardPort) -> bool:
    """The robot lacks nothing but the release of its latch, the guard could stop it again."""
    state, health = robot.state(), guard.health()
    # The latch is what the stop has just set and what rearming will release; everything else that
    # makes a robot not ready needs a person.
    able = replace(state, stop_latched=False).ready
    return able and health.alive and health.stop_channel_up
