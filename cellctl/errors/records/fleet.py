"""83x: the records of many cells in one database, which no running cell needs."""

from cellctl.errors.base import Reaction
from cellctl.errors.records.store import RecordsError


class FleetError(RecordsError):
    """The fleet database could not be used."""

    reaction = Reaction.WARN


class FleetUnreachable(FleetError):
    """The fleet database does not answer, or not in time."""

    number = 831
    text = "Fleet database does not answer"
    cause = "Its server or the network is down, overloaded, or out of disk space."
    remedy = "Nothing is lost: the cell keeps its records and delivers them later. See the "
    remedy += "detail for what the server said; `cellctl fleet cells` tries it."


class FleetRefused(FleetError):
    """The fleet database knows this user or this cell not, or grants too little."""

    number = 832
    text = "Fleet database refuses access"
    cause = "The database is no fleet's, lacks the cell, or grants this user too little."
    remedy = "Its owner makes it a fleet's: `cellctl fleet init`; cells: `cellctl fleet add`."


class FleetDiffers(FleetError):
    """The fleet database holds other records under the name of this cell."""

    number = 833
    text = "Fleet database holds other records of this cell"
    cause = "The run store was replaced or restored from a backup, two cells have one name, or "
    cause += "somebody has changed records here or there."
    remedy = "Nothing more is delivered. Compare `cellctl runs verify` with `cellctl fleet verify`;"
    remedy += " a store that begins anew needs a new name in the cell file and `cellctl fleet add`."


class FleetOutdated(FleetError):
    """The tables of the fleet database are older than the records of this cell."""

    number = 834
    text = "Fleet database has tables of an earlier version"
    cause = "The cell was upgraded before the fleet database."
    remedy = "Its administrator runs `cellctl fleet migrate` of the new version; delivery goes on."


class FleetNotInstalled(FleetError):
    """The library that speaks with PostgreSQL is missing."""

    number = 835
    text = "The library for PostgreSQL is not installed"
    cause = "cellctl was installed without its extra for fleets."
    remedy = "Install it: `pip install cellctl[fleet]`."


class RecordUndeliverable(FleetError):
    """A record holds what PostgreSQL cannot keep."""

    number = 836
    text = "A record cannot be kept by the fleet database"
    cause = "A text of it holds a character that PostgreSQL refuses, such as a zero byte."
    remedy = "Report it with the detail: delivery stays at this record, the cell goes on."


class FleetNotNamed(FleetError):
    """Nobody said which database, or not in a form that is accepted."""

    number = 837
    text = "No usable address of a fleet database"
    cause = "`[fleet]` in the cell file, `--store` or the password's file is missing or wrong."
    remedy = "Give `postgresql://USER@HOST:PORT/DATABASE` as `url` under `[fleet]` or as "
    remedy += "`--store`, and the password in a file or in `CELLCTL_FLEET_PASSWORD`."
