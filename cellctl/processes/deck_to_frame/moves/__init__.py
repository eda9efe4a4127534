"""Moves outside of the steps: the deck off the station, and all robots to where a run begins."""
