"""A worker process: reads jobs from standard input, writes rows to disk, answers on its output.

``python -m tautwire.studies.execution.worker FOLDER``. Every line is one JSON document. A finished
case is on disk before it is reported, so nothing is lost when the process that started the worker
dies; the worker then notices the end of its input and ends at once.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
from collections.abc import Mapping
from queue import SimpleQueue
from typing import IO, Any

from tautwire.studies.execution.task import Job, perform
from tautwire.studies.store import Store

WORKER_MODULE = "tautwire.studies.execution.worker"
READY, FINISHED, UNWRITABLE = "ready", "finished", "unwritable"


def serve(folder: str, jobs: IO[str], answers: IO[str]) -> None:
    """Compute jobs until the input ends.

    Parameters
    ----------
    folder
        Folder of the study.
    jobs
        One JSON document per line.
    answers
        One JSON document per line.
    """
    store = Store(folder)
    waiting: SimpleQueue[str] = SimpleQueue()
    threading.Thread(target=_listen, args=(jobs, waiting), daemon=True).start()
    _answer(answers, {"event": READY})
    while True:
        job = Job(**json.loads(waiting.get()))
        _answer(answers, _computed(store, job))


def _computed(store: Store, job: Job) -> dict[str, Any]:
    """Compute a job, store its row, and return the answer."""
    try:
        outcome = perform(job)
        store.save(job.key, outcome.row, outcome.run_file)
    except OSError as error:
        return {"event": UNWRITABLE, "key": job.key, "reason": error.strerror or str(error)}
    row = outcome.row
    return {"event": FINISHED, "key": job.key, "status": row["status"], "reason": row["reason"]}


def _listen(jobs: IO[str], waiting: SimpleQueue[str]) -> None:
    """Take jobs as they come; end the process at the end of the input."""
    for line in jobs:
        waiting.put(line)
    os._exit(0)


def _answer(answers: IO[str], document: Mapping[str, Any]) -> None:
    answers.write(json.dumps(document) + "\n")
    answers.flush()


def main() -> None:
    """Run the worker; what a case prints goes to standard error."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that started this one
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    serve(sys.argv[1], sys.stdin, answers)


if __name__ == "__main__":
    main()
