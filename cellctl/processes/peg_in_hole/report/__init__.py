"""What the report of an insertion shows besides the pages of any run."""
