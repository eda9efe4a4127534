"""Procedures of Maintenance: calibrations, and what is taught."""
