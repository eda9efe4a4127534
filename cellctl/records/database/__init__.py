"""The SQLite file behind the run store: tables, migration, seals."""
