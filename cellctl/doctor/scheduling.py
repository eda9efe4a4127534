"""Whether the force guard gets its processor in time."""

from collections.abc import Iterator
from pathlib import Path

from cellctl.config.cell import CellConfig
from cellctl.doctor.finding import Finding, bad, doubtful, good
from cellctl.doctor.pc import Pc
from cellctl.doctor.service import Service
from cellctl.guard.limits import GuardSettings

_LEAST_PROCESSORS = 2
_REAL_TIME_SHARE = "/proc/sys/kernel/sched_rt_runtime_us"
_GOVERNORS = "/sys/devices/system/cpu/cpu*/cpufreq/scaling_governor"


def scheduling_findings(pc: Pc, service: Service, cell: CellConfig | None) -> Iterator[Finding]:
    """Real-time priority, locked memory, processors and their speed."""
    yield _priority(service)
    yield _locked_memory(service)
    yield _share(pc)
    yield from _processors(pc, cell)
    slow = {path.parent.parent.name for path in pc.find(_GOVERNORS) if _saves_power(pc, path)}
    if slow:
        yield doubtful(
            "processor speed",
            f"{', '.join(sorted(slow))} slow down when there is little to do",
            "sudo cpupower frequency-set -g performance",
        )


def _priority(service: Service) -> Finding:
    # Without a line in the unit the service may ask for no real-time priority at all.
    written, asked = service.last("LimitRTPRIO", "0"), GuardSettings().fifo_priority
    if written == "infinity" or (written.isdigit() and int(written) >= asked):
        return good("real-time priority", f"the unit allows {written}")
    remedy = f"LimitRTPRIO={asked} or more in a drop-in of the unit"
    return bad("real-time priority", f"the unit allows {written}", remedy)


def _locked_memory(service: Service) -> Finding:
    # 8 MiB is what systemd allows where a unit says nothing; the guard locks about 100 MB
    # (docs/guard.md).
    if (written := service.last("LimitMEMLOCK", "8M")) == "infinity":
        return good("locked memory", "the unit allows it")
    remedy = "LimitMEMLOCK=infinity in a drop-in of the unit"
    return bad("locked memory", f"the unit allows {written}", remedy)


def _share(pc: Pc) -> Finding:
    written = pc.read(_REAL_TIME_SHARE)
    if written == "0":
        remedy = "sudo sysctl kernel.sched_rt_runtime_us=950000"
        return bad("real-time share", "the kernel gives real-time programs no time", remedy)
    kernel = "real-time" if pc.read("/sys/kernel/realtime") == "1" else "ordinary"
    return good("real-time share", f"{written} µs of each second; the kernel is an {kernel} one")


def _processors(pc: Pc, cell: CellConfig | None) -> Iterator[Finding]:
    online = _numbers(pc.read("/sys/devices/system/cpu/online") or "")
    if len(online) < _LEAST_PROCESSORS:
        found = f"{len(online)} processor: guard, daemon and vision wait for each other"
        yield doubtful("processors", found, "a PC with two processors or more")
    else:
        yield good("processors", str(len(online)))
    for name, sensor in (cell.force_sensors if cell else {}).items():
        if sensor.cpu is not None and sensor.cpu not in online:
            subject = f"force_sensors.{name}.cpu"
            found = f"there is no processor {sensor.cpu} for the guard"
            yield bad(subject, found, f"one of {', '.join(map(str, sorted(online)))}")


def _numbers(written: str) -> set[int]:
    """The numbers of a list such as ``0-3,6`` (Documentation/admin-guide/cputopology)."""
    found: set[int] = set()
    for part in filter(None, written.split(",")):
        first, _, last = part.partition("-")
        found |= set(range(int(first), int(last or first) + 1))
    return found


def _saves_power(pc: Pc, governor: Path) -> bool:
    return pc.read(governor) in {"powersave", "ondemand", "conservative"}
