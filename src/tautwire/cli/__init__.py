"""The command line; the only place that prints."""

from tautwire.cli.app import main

__all__ = ["main"]
