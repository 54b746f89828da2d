"""Run the command line: ``python -m tautwire``."""

from tautwire.cli import main

if __name__ == "__main__":
    main()
