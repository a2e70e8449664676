"""Write ``src/seaglint/checksums.sha256``, against which ``seaglint doctor`` compares the data files of the package.

Run it after any change to a file below ``src/seaglint/*/data``: ``python tools/write_checksums.py``.
"""

from __future__ import annotations

from pathlib import Path

from seaglint.cli.doctor import checksum, data_files

ROOT = Path(__file__).resolve().parents[1] / "src" / "seaglint"


def main() -> None:
    """List every data file with its SHA-256, in the format of ``sha256sum``."""
    lines = [f"{checksum(ROOT / name)}  {name}\n" for name in data_files(ROOT)]
    (ROOT / "checksums.sha256").write_text("".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
