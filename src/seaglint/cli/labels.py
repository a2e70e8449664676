"""``seaglint labels``: the truth of a sequence's objects for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.cli.terminal.messages import log
from seaglint.cli.terminal.options import Overwrite


def labels(
    run: Annotated[Path, typer.Argument(metavar="RUN.zarr", help="finished sequence of 'seaglint render' with objects")],
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write: .json (COCO) or .csv")],
    overwrite: Overwrite = False,
) -> None:
    """Write places, masks and contrasts of objects, by frame.

    'seaglint labels run.zarr -o labels.csv' writes a row for each object and frame, 'seaglint labels run.zarr -o labels.json' COCO's
    annotations with masks, boxes and track numbers.
    """
    from seaglint.files.outputs import refuse_existing
    from seaglint.files.store.object_labels import Labels, report_never_seen, require_labels_name, write_labels

    refuse_existing(require_labels_name(output), overwrite=overwrite, inputs=[run])
    truth = Labels.of(run)
    report_never_seen(truth)
    write_labels(truth, output, overwrite=overwrite)
    log(f"{output} written: {len(truth.names)} object{'s' * (len(truth.names) != 1)} in {len(truth.frames)} frames")
    if output.suffix.lower() == ".json":
        log("its images have no file_name, as no pictures are written (id is the frame's number); 'seaglint dataset' writes them")
