"""Newton's method, shape finding and the loaded line."""
