"""What the record of an insertion holds, by which names, and how it is written."""
