"""Sections of pages and what they are built from."""
