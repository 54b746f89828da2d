"""What the product knows by name: cases, pantographs, limits, references; each with its source."""
