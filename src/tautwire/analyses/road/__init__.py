"""From the case to the passage: shape, elasticity, dynamics, mean force."""
