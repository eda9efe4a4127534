"""8xx: the run store of one cell, the files of its runs, and what is made of them."""

from cellctl.errors.base import CellError, Reaction


class RecordsError(CellError):
    """The record could not be kept."""


class StoreUnavailable(RecordsError):
    """The run store cannot be opened."""

    number = 801
    text = "Run store cannot be opened"
    cause = "No runs are kept in this folder yet, it is missing or not writable, the disk is full, "
    cause += "or the database is damaged."
    remedy = "Check data_dir in the cell file, or the folder named with --data-dir, and the "
    remedy += "disk. A store that is damaged is restored from its backup."


class StoreTooNew(StoreUnavailable):
    """The run store was written by a later version of cellctl."""

    number = 810
    text = "Run store was written by a later version of cellctl"
    cause = "cellctl was replaced by an earlier version after the store had been migrated."
    remedy = "Install the later version again, or go on in another data_dir."


class StoreContradictsVersion(StoreUnavailable):
    """The run store holds what the version that it claims could not have written."""

    number = 826
    text = "Run store holds what its version could not have written"
    cause = "store.sqlite was edited, given a trigger or a view, or made of parts of two stores."
    remedy = "Keep it as evidence: records may be forged. Restore the store from its backup."


class StoreHeldByEarlierVersion(StoreUnavailable):
    """A daemon of an earlier version works with the store, so that it is not migrated."""

    number = 815
    text = "Run store is in use by a daemon of an earlier version"
    cause = "A command or a second daemon of a later version was started beside a running daemon."
    remedy = "Use the commands of the running version. Stop its daemon between runs to upgrade."
    reaction = Reaction.STOP


class StoreInUse(RecordsError):
    """Another daemon owns the run store."""

    number = 802
    text = "Run store is in use by another daemon"
    cause = "A second cellctl was started on the same data_dir."
    remedy = "Stop the other daemon or give this one its own data_dir."
    reaction = Reaction.STOP


class RecordNotWritten(RecordsError):
    """A record did not reach the disk."""

    number = 803
    text = "A record could not be written"
    cause = "Disk full, failing or read-only; or a command of a user who may not write the store."
    remedy = "Make room on the disk or repair it, then restart the daemon: until then nothing is "
    remedy += "retried and no Start is taken. Use the cell's user account."


class StoreLocked(RecordsError):
    """Another program held the lock of the run store for too long; nothing was written."""

    number = 825
    text = "Another program keeps the run store locked"
    cause = "A program that writes to store.sqlite has not ended, such as a backup."
    remedy = "End it (`fuser store.sqlite` names it), then Clear or repeat. The store is sound."


class RunUnknown(RecordsError):
    """There is no such run."""

    number = 804
    text = "No such run in the store"
    cause = "Mistyped number, or another data_dir."
    remedy = "See `cellctl runs list`."
    reaction = Reaction.STOP


class RunClosed(RecordsError):
    """A closed run was to be changed."""

    number = 805
    text = "The run is closed and cannot be changed"
    cause = "A defect, or a run that was closed as interrupted."
    remedy = "Keep the log and report it."
    reaction = Reaction.STOP


class RecordAltered(RecordsError):
    """Somebody else has changed what the daemon had written: of an open run, or of the ledger."""

    number = 827
    text = "Records were changed beside the daemon"
    cause = "Another program has written to store.sqlite, or the disk has lost what it had taken."
    remedy = "An open run counts as bad. Keep store and journal; see `cellctl runs verify`."
    reaction = Reaction.STOP


class ArtefactDamaged(RecordsError):
    """A stored file is missing or not what was stored."""

    number = 806
    text = "A stored file is missing or has changed"
    cause = "Deleted or edited by hand, or a failing disk."
    remedy = "Restore the file from the backup; do not trust this run's files until then."
    reaction = Reaction.STOP


class RecordingUnreadable(RecordsError):
    """A force recording holds nothing that can be read."""

    number = 807
    text = "Force recording cannot be read"
    cause = "Not a recording, or cut before its first chunk."
    remedy = "Use the figures of the run record."
    reaction = Reaction.WARN


class ValueRefused(RecordsError):
    """A value does not belong into the record."""

    number = 808
    text = "Value refused by the run store"
    cause = "Mistyped, or outside what can be measured."
    remedy = "See the detail for what is allowed."
    reaction = Reaction.WARN


class FigureBeyondLimit(RecordsError):
    """A run came to its end with a figure that is not within its limit."""

    number = 811
    text = "A figure of the run is beyond its limit"
    cause = "The part or the work on it is not as the recipe demands; the detail names the figures."
    remedy = "Look at the figures in the report; the part counts as bad until somebody decides."
    reaction = Reaction.STOP


class GaugeRefused(RecordsError):
    """A plug-gauge result cannot be of this run."""

    number = 812
    text = "Gauge result refused"
    cause = "Mistyped hole, diameter or run number, or a run that ended before its part was made."
    remedy = "The detail tells holes and diameters of the run; `cellctl runs list` shows the runs."
    reaction = Reaction.WARN


class NotReplayable(RecordsError):
    """A run cannot be computed anew from its record."""

    number = 813
    text = "The run cannot be replayed"
    cause = "Its process cannot compute such a run anew, or the record lacks raw images or "
    cause += "readings: an end before it measured, an old version, or a file that is missing."
    remedy = "See the detail for what is missing; `cellctl runs verify` finds damaged files."
    reaction = Reaction.WARN


class RunInterrupted(RecordsError):
    """A run that no daemon has closed; found at the next start."""

    number = 821
    text = "A run was not closed before the daemon ended"
    cause = "Told at its start: it was killed, the PC went down, or the disk took no more writes."
    remedy = "Look at arm and part as told; then Reset (in Aborted first Clear): it lifts off."
    reaction = Reaction.WARN


class DiskNearlyFull(RecordsError):
    """There is too little room to record another run."""

    number = 814
    text = "Too little space on the disk for another record"
    cause = "The run store, or something else on the disk, has grown."
    remedy = "Nothing has moved. Make room: move the oldest runs with their store to an archive,"
    remedy += " or give the store a larger disk. Start is taken again as soon as there is room."
    reaction = Reaction.WARN


class RecordSilent(RecordsError):
    """The disk did not open, continue or close the record of a run in time."""

    number = 820
    text = "The disk did not take the record of a run in time"
    cause = "Disk overloaded or failing, or a file system that hangs."
    remedy = "Check the disk. The record is completed when the disk answers; see cellctl runs show."


class DiskSilent(RecordsError):
    """The disk did not take or give what a command waits for."""

    number = 809
    text = "The disk did not answer in time"
    cause = "Disk overloaded or failing, or a file system that hangs."
    remedy = "The command was not carried out: give it again. Check the disk if it happens again."
    reaction = Reaction.WARN


class PdfNotMade(RecordsError):
    """The report cannot be laid out as PDF on this computer."""

    number = 818
    text = "The report could not be made as PDF"
    cause = "The libraries of the system that lay out text (Pango, HarfBuzz) are not installed."
    remedy = "Install them: apt install libpango-1.0-0 libpangoft2-1.0-0 libharfbuzz-subset0. The "
    remedy += "report as HTML needs none of them."
    reaction = Reaction.WARN


class ExportFolderTaken(RecordsError):
    """A run is not exported among the files of another one."""

    number = 824
    text = "The folder holds the export of another run"
    cause = "The same --out was given for two runs; files of both would lie under one report."
    remedy = "Give a folder of its own, or none: `cellctl runs export RUN` makes run-RUN."
    reaction = Reaction.WARN
