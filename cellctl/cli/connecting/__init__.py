"""`cellctl check --connect`: every device of a cell file is asked who it is, and nothing moves."""
