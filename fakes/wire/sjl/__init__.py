"""A robot controller whose job program speaks SJL/1 (docs/protocols/sjl-1.md)."""
