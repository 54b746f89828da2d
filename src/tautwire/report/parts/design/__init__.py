"""What those who design a line read of its states."""
