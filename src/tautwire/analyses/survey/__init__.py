"""The line as built, from what a crew or a train measured of its geometry."""
