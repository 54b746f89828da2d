"""Studies: a base case, what varies, and everything that came out as one table."""
