"""Runs beside what was measured: force, position of the wire, elasticity, uplift."""
