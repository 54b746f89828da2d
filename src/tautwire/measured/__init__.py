"""Recordings of measuring trains: what they hold, how they are processed, checked and aligned."""
