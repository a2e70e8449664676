"""A format that is added to the closed set is known to help texts, errors, writing and checking."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest
import xarray as xr
from small_scenes import entries

import seaglint.formats.dataset
import seaglint.formats.export
from seaglint.base.errors import DataError
from seaglint.formats.dataset import dataset_writing
from seaglint.formats.dataset.scene_records import SPLITS, DatasetFormat
from seaglint.formats.export.file_formats import ExportFormat
from seaglint.formats.export.stack import select
from seaglint.plot.run_export import write_stack
from seaglint.scenario.records.ensemble_tables import Dataset
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, DatasetPlan, make_dataset


class Names(DatasetFormat):
    """Pictures and a list of them."""

    name: ClassVar = "names"
    layout: ClassVar = "`images/` and `names.txt`"
    folders: ClassVar = ("images",)

    @classmethod
    def write(cls, folder, catalogue, about):
        (folder / "names.txt").write_text("".join(f"{picture.name}\n" for part in catalogue.parts for picture in part.pictures))

    @classmethod
    def problems(cls, folder, about):
        if not (folder / "names.txt").read_text():
            yield "names.txt: is empty"


class Sums(ExportFormat):
    """Sum of each frame."""

    endings: ClassVar = (".sum",)
    note: ClassVar = "one number a frame"

    @classmethod
    def write(cls, path, stack, numbers, frames):
        path.write_text("".join(f"{frame.sum():g}\n" for frame in frames))


@pytest.fixture
def added(monkeypatch):
    monkeypatch.setattr(seaglint.formats.dataset, "FORMATS", (*seaglint.formats.dataset.FORMATS, Names))
    monkeypatch.setattr(seaglint.formats.export, "FORMATS", (*seaglint.formats.export.FORMATS, Sums))


def test_a_format_of_data_sets(added, tmp_path):
    plan = DatasetPlan("small", 3, Dataset(), "[ensemble]\nscenes = 3\n")
    stores = entries(tmp_path / "stores", 3, SPLITS, counts=True)
    folder = make_dataset(tmp_path / "D", plan, DatasetOptions.of("names"), lambda _: stores)
    assert len((folder / "names.txt").read_text().split()) == len(list((folder / "images").glob("*.png")))
    assert Names.layout in (folder / "README.md").read_text()
    (folder / "names.txt").write_text("")
    dataset_writing.write_sums(folder)
    assert list(dataset_writing.problems(folder)) == ["names.txt: is empty"]
    with pytest.raises(DataError, match="zarr, names;"):
        DatasetOptions.of("voc")


def test_an_ending_of_exports(added, tmp_path):
    stack = select(xr.Dataset({"radiance": (("time", "y", "x"), np.ones((2, 3, 4), np.float32))}))
    write_stack(stack, tmp_path / "x.sum")
    assert (tmp_path / "x.sum").read_text() == "12\n12\n"
    with pytest.raises(DataError, match=r"\.raw, \.sum$"):
        write_stack(stack, tmp_path / "x.png")


@pytest.mark.parametrize(
    ("command", "texts"), [("dataset", ("the scenes' stores as they are or names",)), ("export", (".sum (one number a frame)",))]
)
def test_help_lists_them(added, command, texts):
    from typer.main import get_command

    from seaglint.cli.app import app

    group = get_command(app)
    chosen = group.get_command(None, command)
    page = " ".join(chosen.get_help(chosen.make_context(command, [], resilient_parsing=True)).split())
    assert all(text in page for text in texts)
