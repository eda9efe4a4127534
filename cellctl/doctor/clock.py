"""Whether the clock is right: records, calibrations and their validity carry its time."""

from collections.abc import Iterator

from cellctl.doctor.finding import Finding, bad, doubtful, good
from cellctl.doctor.pc import Pc

_BUILT_S = 1_767_225_600
"""2026-01-01 00:00 UTC. No version of this software is older, so that a clock which shows an
earlier time is wrong for certain, whatever it says of its synchronisation."""
_RTC_OFF_S = 60.0
"""Largest difference to the clock with the battery, from which the PC starts without a network."""


def clock_findings(pc: Pc) -> Iterator[Finding]:
    """Synchronised, past the date of this software, and the same as the clock with the battery."""
    now_s = pc.time_s()
    if now_s < _BUILT_S:
        remedy = "set date and time, or start a time service: sudo timedatectl set-ntp true"
        yield bad("clock", "it stands before the date of this software", remedy)
        return
    if pc.clock_is_set():
        yield good("clock", "synchronised")
    else:
        remedy = "start a time service: sudo timedatectl set-ntp true"
        found = "not synchronised: times of two cells cannot be compared"
        yield doubtful("clock", found, remedy)
    written = pc.read("/sys/class/rtc/rtc0/since_epoch")
    if written and abs(off_s := int(written) - now_s) > _RTC_OFF_S:
        found = f"off by {off_s:.0f} s, which the next start without network begins with"
        yield doubtful("clock with battery", found, "sudo hwclock --systohc; a new battery?")
