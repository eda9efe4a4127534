"""The SQLite file behind the run store: tables, migration, reading; ``sealing`` proves it whole."""
