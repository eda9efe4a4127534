"""How the delivery of a cell's records to a fleet database goes, told to other programs by a file.

The forwarder writes it at each turn; doctor and page read it. A folder that the PC forgets when it
starts is the right place: the file says what goes on now, and nothing of the records.
"""

from datetime import datetime
from pathlib import Path

from pydantic import AwareDatetime, BaseModel, ConfigDict, ValidationError

from cellctl.files.atomic_files import write_durably

FOLDER = Path("/run/cellctl-forward")
"""``RuntimeDirectory`` of the shipped unit."""
NAME = "delivery.json"
SILENT_S = 180.0
"""A forwarder that has reported nothing for this time has ended or hangs. It reports at least once
a minute, and a server that answers slowly may keep it for another minute."""


class DeliveryState(BaseModel):
    """What the forwarder knew at its last turn."""

    model_config = ConfigDict(frozen=True, extra="ignore")

    told: AwareDatetime
    delivered: AwareDatetime | None
    """When all or a part arrived last, since the forwarder started."""
    still_to_come: int | None
    """Entries of the ledger; None before the server has answered for the first time."""
    fault: str = ""
    """Why nothing is delivered; empty while all is well."""
    remedy: str = ""

    def silent(self, now: datetime) -> bool:
        """Whether the forwarder itself seems to be gone."""
        return (now - self.told).total_seconds() > SILENT_S


def write_state(folder: Path, state: DeliveryState) -> None:
    """Replace what the file said; raises ``OSError``."""
    write_durably(folder / NAME, state.model_dump_json().encode())


def read_state(text: str) -> DeliveryState | None:
    """The state in the text of the file; None where it is not one."""
    try:
        return DeliveryState.model_validate_json(text)
    except ValidationError:
        return None
