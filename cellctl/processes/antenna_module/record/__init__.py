"""What the record of a plugging holds, by which names, and how it is written."""
