"""The record of a run, as far as it can be read, and a list of what cannot."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from cellctl.errors.records.store import ArtefactDamaged, RecordingUnreadable
from cellctl.records.entries import Artefact, AuditEntry, Calibration, RunRecord
from cellctl.records.files.artefacts import ArtefactFolder
from cellctl.records.files.mcap_reading import RawContent, read_raw


@dataclass(slots=True)
class RunSources:
    """What a recording is composed of."""

    record: RunRecord
    audit: Sequence[AuditEntry]
    """The audit log of the time of the run."""
    calibrations: Sequence[Calibration]
    """The calibrations that the run used."""
    files: ArtefactFolder
    missing: list[str] = field(default_factory=list)
    """What the recording lacks, for people; grows while messages are made."""

    def read(self, artefact: Artefact) -> bytes | None:
        """The bytes of a file; None, and a line of what is missing, when it is damaged."""
        try:
            return self.files.get(artefact.sha256)
        except ArtefactDamaged as fault:
            self.missing.append(f"{artefact.name}: {fault}")
            return None

    def recording(self, artefact: Artefact) -> RawContent | None:
        """The messages of a recording as far as they can be read; None when that is nowhere."""
        data = self.read(artefact)
        if data is None:
            return None
        try:
            content = read_raw(data)
        except RecordingUnreadable as fault:
            self.missing.append(f"{artefact.name}: {fault}")
            return None
        if not content.complete:
            last = f" after {len(content.messages)} messages" if content.messages else ""
            self.missing.append(f"{artefact.name} ends early{last}")
        return content
