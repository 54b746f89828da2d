"""The line: wires, supports, droppers and their irregularities."""
