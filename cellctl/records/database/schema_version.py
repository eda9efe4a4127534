"""The schema of the run store, for whoever reads it without loading its tables."""

SCHEMA_VERSION = 5
"""``PRAGMA user_version`` of the database; see ``migration.py`` for older ones."""
FILE = "store.sqlite"
"""Name of the database in the folder of the store."""
