"""In what state a line is: its weather, its wear, its defects."""
