"""Time stepping: the readable reference, the compiled core and what they share."""
