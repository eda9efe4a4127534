"""What the report of a plugging shows besides the pages of any run."""
