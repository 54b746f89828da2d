"""Whether a line as designed keeps what is asked of it."""
