"""Searches and insertions by touch over many seeds."""
