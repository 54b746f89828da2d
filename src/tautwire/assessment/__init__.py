"""Limits, checks, wave quantities, and comparison with measurements and reference ranges."""
