"""What one section of a cell file says, held against what another one says."""
