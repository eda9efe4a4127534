"""What `cellctl --help` and `man cellctl` show of the commands, and how they group them."""
