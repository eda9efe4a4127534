"""Errors that authors of robots' drivers make, each in the Beta driver of the guide.

``clause`` is the one of the contract that must find it.
"""

from typing import NamedTuple


class Mutation(NamedTuple):
    """One text of one file replaced by another."""

    error: str
    file: str
    old: str
    new: str
    clause: str


_BOUNDED = "test_targets_are_bounded"
_READY = "test_an_arm_that_is_not_ready_is_not_moved"
_ARRIVES = "test_turns_and_joints_arrive_as_they_were_meant"
_RIGHT = "test_state_is_fresh_and_right"
_ENDS = "test_moves_end_at_standstill_on_target"
_FAST = "test_the_arm_goes_as_fast_as_it_was_told"
_JOINTS = "test_joints_turn_as_fast_as_they_were_told"
_GUARD = "test_reports_are_fresh_and_well_formed"
_STEP = "distance_mm <= config.max_step_mm and angle_deg <= config.max_step_deg"
_WAITS = "        await self._link.until(lambda seen: not seen.state.moving)\n"
_OPENED = "        await self._link.open()\n\n    async def disconnect"
_CHECKED = """        self._bounds.pose(base_T_flange)
        speed_mm_s = self._bounds.speed_mm_s(speed_m_s)
        self._bounds.step"""
_IN_BOX = "if not ((self._low_mm <= at_mm).all() and (at_mm <= self._high_mm).all()):"
_REFUSED = """            raise MotionRejected(f"{self._peer}: {self._refusals.pop(number)}")"""
_SENT = "*pose_to_xyzabc(pose), speed_mm_s, ramp_mm_s2"
_TURNED_ABOUT = "*pose_to_xyzabc(pose)[:3], *pose_to_xyzabc(pose)[5:2:-1], speed_mm_s, ramp_mm_s2"
_HEARD = "pose_from_xyzabc(numbers[:6])"

MUTATIONS = (
    # --- bounds
    Mutation(
        "speed without bound",
        "bounds.py",
        "if not 0.0 < speed_mm_s <= self._config.max_speed_mm_s:",
        "if False:",
        _BOUNDED,
    ),
    Mutation(
        "ramp that is no number",
        "bounds.py",
        "if not (acceleration_m_s2 > 0.0 and math.isfinite(acceleration_m_s2)):",
        "if acceleration_m_s2 <= 0.0:",
        _BOUNDED,
    ),
    Mutation(
        "ratio above one",
        "bounds.py",
        "if not 0.0 < speed_ratio <= 1.0:",
        "if not 0.0 < speed_ratio:",
        _BOUNDED,
    ),
    Mutation(
        "box that takes no number",
        "bounds.py",
        _IN_BOX,
        "if (at_mm < self._low_mm).any() or (at_mm > self._high_mm).any():",
        _BOUNDED,
    ),
    Mutation(
        "step of any angle", "bounds.py", _STEP, "distance_mm <= config.max_step_mm", _BOUNDED
    ),
    Mutation(
        "step of any length", "bounds.py", _STEP, "angle_deg <= config.max_step_deg", _BOUNDED
    ),
    Mutation(
        "step without the box",
        "driver.py",
        _CHECKED,
        _CHECKED.split("\n", 1)[1],
        "test_a_step_does_not_leave_the_bounds",
    ),
    Mutation(
        "joints without bounds",
        "driver.py",
        "        self._bounds.joints(joints_rad)\n        percent",
        "        percent",
        _BOUNDED,
    ),
    Mutation(
        "bounds not stated",
        "driver.py",
        "speed_m_s=config.max_speed_mm_s * MM,",
        "",
        "test_bounds_are_stated",
    ),
    # --- units and order of angles
    Mutation(
        "metres for millimetres",
        "bounds.py",
        "speed_mm_s = speed_m_s / MM\n",
        "speed_mm_s = speed_m_s\n",
        _FAST,
    ),
    Mutation(
        "ten times as fast",
        "protocol.py",
        "*pose_to_xyzabc(pose), speed_mm_s, ramp_mm_s2",
        "*pose_to_xyzabc(pose), 10 * speed_mm_s, ramp_mm_s2",
        _FAST,
    ),
    Mutation(
        "ten times as fast by steps",
        "protocol.py",
        "*pose_to_xyzabc(pose), speed_mm_s])",
        "*pose_to_xyzabc(pose), 10 * speed_mm_s])",
        _FAST,
    ),
    Mutation(
        "ramp in metres",
        "bounds.py",
        "return acceleration_m_s2 / MM",
        "return acceleration_m_s2",
        "test_the_arm_gets_faster_as_it_was_told",
    ),
    Mutation(
        "ramp in micrometres",
        "bounds.py",
        "return acceleration_m_s2 / MM",
        "return acceleration_m_s2 / MM**2",
        "test_the_arm_gets_faster_as_it_was_told",
    ),
    Mutation(
        "ratio for percent",
        "bounds.py",
        "return 100.0 * speed_ratio",
        "return speed_ratio",
        _JOINTS,
    ),
    Mutation(
        "percent of percent",
        "bounds.py",
        "return 100.0 * speed_ratio",
        "return 10000.0 * speed_ratio",
        _JOINTS,
    ),
    Mutation(
        "override in percent",
        "protocol.py",
        "_whole(override, line) / 100.0",
        "float(_whole(override, line))",
        "test_the_override_is_a_ratio",
    ),
    Mutation("radians sent", "protocol.py", "*np.degrees(joints_rad)", "*joints_rad", _ARRIVES),
    Mutation(
        "degrees read", "protocol.py", "np.radians(numbers[6:])", "np.array(numbers[6:])", _RIGHT
    ),
    Mutation("angles sent in another order", "protocol.py", _SENT, _TURNED_ABOUT, _ARRIVES),
    Mutation(
        "angles read in another order",
        "protocol.py",
        _HEARD,
        "pose_from_xyzabc([*numbers[:3], *numbers[5:2:-1]])",
        _RIGHT,
    ),
    # --- panel and motion
    Mutation("drives", "protocol.py", "drives_on=_yes(drives, line)", "drives_on=True", _READY),
    Mutation("error", "protocol.py", "error_code=_whole(error, line)", "error_code=0", _READY),
    Mutation("key", "protocol.py", '"T": RobotMode.MANUAL', '"T": RobotMode.REMOTE', _READY),
    Mutation("readiness", "driver.py", "        if not state.ready:", "        if False:", _READY),
    Mutation(
        "ended without standstill",
        "connection.py",
        "return report.ended == number and not report.state.moving",
        "return report.ended == number",
        _ENDS,
    ),
    Mutation(
        "refusal",
        "connection.py",
        _REFUSED,
        "            self._refusals.pop(number)",
        "test_a_motion_that_the_controller_refuses_is_raised",
    ),
    Mutation(
        "age of the report",
        "connection.py",
        "if age_s > max_age_s:",
        "if False:",
        "test_no_report_is_younger_than_it_is",
    ),
    Mutation(
        "reports that stay away",
        "connection.py",
        "async with asyncio.timeout(self._config.stale_s):",
        "async with asyncio.timeout(60.0):",
        "test_reports_that_stay_away_end_a_motion",
    ),
    # --- latch
    Mutation(
        "latch released by connecting",
        "driver.py",
        _OPENED,
        """        await self._link.open()
        self._latched = False
        self._link.send(protocol.RELEASE)

    async def disconnect""",
        "test_connecting_releases_no_latch",
    ),
    Mutation(
        "latch of the controller only",
        "driver.py",
        "        self._latched = True\n",
        "        pass\n",
        "test_the_driver_remembers_a_stop_itself",
    ),
    Mutation(
        "lost link not latched",
        "driver.py",
        "BetaConnection(config, self._latch)",
        "BetaConnection(config, lambda: None)",
        "test_a_lost_link_is_latched_until_rearmed",
    ),
    Mutation(
        "heartbeats after StopFailed",
        "driver.py",
        "            await self._link.close()\n            raise StopFailed",
        "            raise StopFailed",
        "test_a_stop_that_is_not_confirmed_ends_every_sign_of_life",
    ),
    Mutation(
        "stop that does not wait",
        "driver.py",
        "await self._link.until(lambda seen: seen.state.stop_latched and not seen.state.moving)",
        "pass",
        "test_stop_ends_a_motion_at_standstill",
    ),
    Mutation(
        "stop that waits for the latch only",
        "driver.py",
        "seen.state.stop_latched and not seen.state.moving",
        "seen.state.stop_latched",
        "test_stop_ends_a_motion_at_standstill",
    ),
    Mutation(
        "cancelled without a stop",
        "driver.py",
        "            await self.stop()\n            raise\n",
        "            raise\n",
        "test_cancellation_stops_first",
    ),
    Mutation(
        "rearmed too early",
        "driver.py",
        _WAITS,
        "",
        "test_link_loss_fails_at_once_and_never_resumes",
    ),
    Mutation(
        "rearmed at once",
        "driver.py",
        _WAITS,
        "        self._latched = False\n",
        "test_link_loss_fails_at_once_and_never_resumes",
    ),
    Mutation(
        "no heartbeats",
        "connection.py",
        "self._streams[1].write(protocol.BEAT)",
        "pass",
        "test_one_motion_at_a_time",
    ),
    # --- stop channel
    Mutation(
        "guard's matrix by columns",
        "protocol.py",
        "        tuple(rotation),\n",
        "        tuple(matrix.T.ravel().tolist()),\n",
        _GUARD,
    ),
    Mutation(
        "guard's place in mm",
        "protocol.py",
        "(x_mm * MM, y_mm * MM, z_mm * MM)",
        "(x_mm, y_mm, z_mm)",
        _GUARD,
    ),
    Mutation(
        "guard's latch for motion",
        "protocol.py",
        "        _yes(words[1], line),\n        _yes(words[2], line),",
        "        _yes(words[2], line),\n        _yes(words[1], line),",
        "test_stop_works_twice_and_latches",
    ),
    Mutation(
        "guard without heartbeat",
        "stop_channel.py",
        "self._send(protocol.BEAT)",
        "return None",
        "test_close_in_any_state",
    ),
    Mutation(
        "guard that waits",
        "stop_channel.py",
        "link.settimeout(0.0)",
        "link.settimeout(2.0)",
        "test_poll_does_not_block",
    ),
    Mutation(
        "guard that reads for ever",
        "stop_channel.py",
        "range(_READS_PER_POLL)",
        "iter(int, 1)",
        "test_poll_reads_a_bounded_amount",
    ),
)
