"""Modes and harmonic response."""
