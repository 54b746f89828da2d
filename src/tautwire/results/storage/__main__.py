"""The child of :mod:`tautwire.results.storage.trial`: reads a file from standard input to its end.

``python -m tautwire.results.storage KIND``.
"""

from __future__ import annotations

import sys

from tautwire.results.storage.reading import UnreadableError, read_everything
from tautwire.results.storage.trial import answer_with, limit_process


def main() -> None:
    """Read the file and answer with what is wrong with it."""
    content = sys.stdin.buffer.read()
    limit_process(len(content))
    ignored: list[str] = []
    sys.unraisablehook = lambda unraisable: ignored.append(str(unraisable.exc_value))
    try:
        read_everything(content, sys.argv[1])
    except UnreadableError as error:
        answer_with(str(error))
    answer_with(f"is damaged ({ignored[0]})" if ignored else None)


if __name__ == "__main__":
    main()
