"""The records of many cells in one PostgreSQL: delivered from each cell, searched across all.

Nothing of it runs in a daemon. Each cell's own store stays the primary record; a forwarder beside
the daemon copies it in the order of its ledger (``cell_records``, ``delivery``, ``forwarder``).
The database (``database``, ``layout``) has one PostgreSQL schema for each cell, with the tables of
the cell's own store, so that the same models read them (``recall``) and the same hash chain is
verified there. See docs/decisions/0027-records-of-many-cells.md.
"""
