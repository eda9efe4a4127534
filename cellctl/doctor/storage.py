"""Whether records find room, on a disk that keeps them."""

from collections.abc import Iterator
from pathlib import Path

from cellctl.config.cell import CellConfig
from cellctl.doctor.finding import Finding, bad, doubtful, good
from cellctl.doctor.pc import Pc
from cellctl.doctor.service import Service, hidden_by
from cellctl.records.files.disk_space import LEAST_FREE_BYTES

_WEEK_BYTES = 20 * LEAST_FREE_BYTES
"""Room for some three hundred runs with their raw images, at 0.15 GB each."""
_FORGETS = {"tmpfs", "ramfs", "overlay"}
"""File systems whose content does not outlive a restart: the first two are memory, the last one is
the disk of a container or of a live system."""
_FAR = {"nfs", "nfs4", "cifs", "smb3", "9p"}


def storage_findings(pc: Pc, service: Service, cell: CellConfig | None) -> Iterator[Finding]:
    """Folder of the records: where it is, on what kind of disk, and how much room it has."""
    written = service.option("--data-dir") or (cell.data_dir if cell else None)
    if written is None:
        return
    folder = Path(service.last("WorkingDirectory", "/")) / written
    if hidden := hidden_by(service, folder):
        remedy = "data_dir or --data-dir below /var/lib/cellctl"
        yield bad("records", f"{folder} is hidden from the service by {hidden}", remedy)
        return
    if not _is_of_the_unit(service, folder):
        yield from _writable(pc, service, folder)
    place = next(parent for parent in (folder, *folder.parents) if pc.path(parent).exists())
    yield from _kind(pc, folder)
    yield _room(pc, folder, place)


def _is_of_the_unit(service: Service, folder: Path) -> bool:
    """Whether systemd makes the folder and gives it to the service."""
    own = Path("/var/lib") / service.last("StateDirectory", "nothing")
    return folder.is_relative_to(own)


def _writable(pc: Pc, service: Service, folder: Path) -> Iterator[Finding]:
    account = pc.user(service.user)
    place = pc.path(folder)
    if service.last("ProtectSystem") == "strict" and not _is_writable_in(service, folder):
        remedy = f"ReadWritePaths={folder} in a drop-in, or a folder below /var/lib/cellctl"
        yield bad("records", f"the unit lets the service write nothing in {folder}", remedy)
    elif account and (not place.exists() or place.stat().st_uid != account.pw_uid):
        remedy = f"sudo install -d -o {service.user} -g {service.groups[0]} {folder}"
        yield bad("records", f"{folder} is not there, or not {service.user}'s", remedy)


def _is_writable_in(service: Service, folder: Path) -> bool:
    written = " ".join(service.settings.get("ReadWritePaths", ())).split()
    # "-" before a path: it may be missing; "+": below the service's root (man 5 systemd.exec).
    return any(folder.is_relative_to(path.lstrip("-+")) for path in written)


def _kind(pc: Pc, folder: Path) -> Iterator[Finding]:
    kind = _file_system(pc.read("/proc/mounts") or "", folder)
    if kind in _FORGETS:
        found = f"{folder} is on {kind}: a power cut takes every record"
        yield bad("disk", found, "a local disk with a journal (ext4, xfs, btrfs)")
    elif kind in _FAR:
        found = f"{folder} is on {kind}: a record waits for the network, and locks may not hold"
        yield doubtful("disk", found, "a local disk; copy records to the server afterwards")
    elif kind:
        yield good("disk", f"{folder} is on {kind}")


def _file_system(mounts: str, folder: Path) -> str:
    """Kind of the innermost mount that holds the folder (man 5 proc: device, place, kind, …)."""
    found, depth = "", -1
    for line in mounts.splitlines():
        _, place, kind, *_ = line.split()
        mounted = Path(place.replace("\\040", " "))
        # Of two mounts on one place the later one hides the earlier one.
        if folder.is_relative_to(mounted) and len(mounted.parts) >= depth:
            found, depth = kind, len(mounted.parts)
    return found


def _room(pc: Pc, folder: Path, place: Path) -> Finding:
    free = pc.free_bytes(pc.path(place))
    found = f"{free / 1e9:.0f} GB free for {folder}"
    remedy = "make room, or give the records a larger disk"
    if free < LEAST_FREE_BYTES:
        return bad("room", f"{found}; no run starts below {LEAST_FREE_BYTES / 1e9:.0f} GB", remedy)
    if free < _WEEK_BYTES:
        return doubtful("room", f"{found}, which some hundred runs fill", remedy)
    return good("room", found)
