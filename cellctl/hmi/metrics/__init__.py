"""Figures of the cell for Prometheus, from the snapshots that the daemon pushes.

The daemon does nothing for them. They count from the start of the page's process; the records of
the cell are in its run store.
"""
