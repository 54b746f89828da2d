"""The compiled core; only :mod:`tautwire.numerics.motion.backend` imports it."""
