"""The compiled core; only :mod:`tautwire.numerics.backend` imports it."""
