"""What those who design masts, gauge and structures ask of the states of a line."""
