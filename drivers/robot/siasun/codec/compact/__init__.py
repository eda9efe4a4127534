"""SJL/2, the form of the protocol for a slow job interpreter (docs/protocols/sjl-2.md)."""
