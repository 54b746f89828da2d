"""Closed forms of the trade: numbers in, numbers out; one equation, one function."""
