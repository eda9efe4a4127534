"""Figures of the second process: vision, chain and insertion of a plug."""
