"""Pages and drawings of the reproduction."""
