"""Commands about measured runs and the line as built."""
