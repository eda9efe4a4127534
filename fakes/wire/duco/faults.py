"""Faults that can be injected into a fake controller of a collaborative arm."""

DUCO_FAULTS = {
    "silent": "nothing is answered any more and no state frame leaves, all sockets stay open",
    "frames_stop": "no state frame leaves",
    "misaligned": "the state stream starts in the middle of a frame",
    "cut": "every connection is closed, and none is accepted until the fault is cleared",
    "stop_ignored": "a stop is answered and not carried out",
    "motion_silent": "a call that moves the arm is carried out, and its connection hangs",
    "motion_late": "a call that moves the arm is taken `delay_s` late, after a stop meanwhile",
    "minus_one": "a call that moves the arm is answered with -1",
    "task_end": "the task of the next motion ends with `state` instead of moving",
    "servo_lost": "a streamed setpoint is answered and not carried out",
    "servo_late": "a streamed setpoint is answered `delay_s` late",
    "unknown": "the call `call` is unknown, by default the one for the version",
    "emergency_stop": "the safety functions are in stop 0 until the fault is cleared",
    "manual_mode": "the key is turned to manual until the fault is cleared",
    "disabled": "the robot is not enabled until the fault is cleared",
    "vendor_error": "the controller shows error `code` until the fault is cleared",
    "collision": "a collision at axis `axis` is not acknowledged",
    "simulation": "the controller only simulates",
    "override": "the override is `percent`",
    "euler": "orientations follow the moving axes x, y', z''",
}
