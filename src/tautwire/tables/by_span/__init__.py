"""Tables of droppers with one row per span."""
