"""Commands that look into the run store: runs, their reports and replays, trends, audit log.

`cellctl calibrations` is here too, because the store keeps what became of every calibration.
"""
