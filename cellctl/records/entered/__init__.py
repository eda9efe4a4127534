"""What people enter into the record of a run: plug gauges and notes, and who entered them."""
