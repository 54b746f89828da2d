"""Modes, wavelengths and transmissibility of the line."""
