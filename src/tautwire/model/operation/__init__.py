"""What a condition does to the arrays of a line, and to the ends of its wires."""
