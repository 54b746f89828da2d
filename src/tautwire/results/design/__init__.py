"""What a line in its states amounts to for those who design it."""
