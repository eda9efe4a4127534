"""Procedures of Maintenance that this process offers."""
