"""What the record of an assembly holds, and under which names."""
