"""Process that computes the workbench's pictures: it reads orders from standard input and writes pictures to standard output."""

from __future__ import annotations

import os
import pickle
import sys

from seaglint.base.errors import SeaglintError
from seaglint.viewer.workbench.small_pictures import PreviewPicture, picture


def main() -> None:
    """Work until the input ends, with the server."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # output of libraries must not mix with the pictures
    from seaglint.studies.mean import mean_map as mean  # noqa: F401 - loaded while nobody waits
    from seaglint.studies.sequence import labelled_frames  # noqa: F401 - loaded while nobody waits

    while True:
        try:
            job, scenario = pickle.load(sys.stdin.buffer)
        # The server has ended, or has closed the pipe.
        except EOFError:
            return
        try:
            answer: tuple[str, PreviewPicture | SeaglintError] = ("picture", picture(job, scenario))
        except SeaglintError as error:
            answer = ("error", error)
        except Exception as error:  # a defect of seaglint is reported, and the page continues to work
            answer = ("error", SeaglintError(f"{type(error).__name__}: {error}; this is a defect of seaglint, please report it"))
        pickle.dump(answer, answers)
        answers.flush()


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):
        sys.exit(0)
