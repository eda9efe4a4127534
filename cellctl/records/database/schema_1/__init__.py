"""Runs of schema 1, which knew one process: their tables, their seal, their details as of today."""

from cellctl.records.database.schema_1.content import sealed_content
from cellctl.records.database.schema_1.reading import Details, read_details
from cellctl.records.database.schema_1.tables import PROCESS

__all__ = ["PROCESS", "Details", "read_details", "sealed_content"]
