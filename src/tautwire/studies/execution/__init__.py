"""Who computes the cases of a study."""
