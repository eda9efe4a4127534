"""Tables that the fleet database has beside those of each cell's own store."""

from datetime import datetime

from sqlalchemy import BigInteger, DateTime, Table, func
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

FLEET = "fleet"
"""PostgreSQL schema of what is known of all cells."""


class FleetBase(DeclarativeBase):
    """Root of the tables in the schema ``fleet``."""


class CellRow(FleetBase):
    """A cell whose records are taken."""

    __tablename__ = "cells"
    __table_args__ = {"schema": FLEET}  # noqa: RUF012  # SQLAlchemy's own name
    name: Mapped[str] = mapped_column(primary_key=True)
    """As in its cell file."""
    place: Mapped[str] = mapped_column(unique=True)
    """PostgreSQL schema with its records."""
    record_schema: Mapped[int]
    """Version of the tables there, as of a run store."""
    added: Mapped[datetime] = mapped_column(DateTime(timezone=True), server_default=func.now())


class PlaceBase(DeclarativeBase):
    """Root of the tables that every cell's schema has beside those of a run store."""


class DeliveryRow(PlaceBase):
    """The last delivery of a cell."""

    __tablename__ = "delivery"
    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    """Always 1."""
    length: Mapped[int] = mapped_column(BigInteger)
    """Entries of the cell's own ledger at that time: more than are here while it catches up."""
    sent: Mapped[datetime] = mapped_column(DateTime(timezone=True))
    """Time by the clock of the cell."""
    received: Mapped[datetime] = mapped_column(DateTime(timezone=True))
    """Time by the clock of the server."""
    software: Mapped[str]


def table_of(row: type[DeclarativeBase]) -> Table:
    """The table of a model, for statements that name it directly."""
    table = row.__table__
    assert isinstance(table, Table)
    return table
