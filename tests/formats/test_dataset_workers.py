"""Data sets whose scenes are written by others: folders that they find, signals that end them."""

import os
import pickle
import signal
from contextlib import chdir, contextmanager
from pathlib import Path

import pytest
from small_scenes import entries

from seaglint.cluster import Job, ThisProcess
from seaglint.cluster.job import outgoing
from seaglint.formats.dataset import dataset_writing
from seaglint.formats.dataset.scene_records import SPLITS
from seaglint.scenario.records.ensemble_tables import Dataset
from seaglint.store.sequence_store import Interrupted
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, DatasetPlan, make_dataset

PLAN = DatasetPlan("small", 3, Dataset(), "[ensemble]\nscenes = 4\n")


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    return entries(tmp_path_factory.mktemp("stores"), 4, SPLITS, counts=True)


class Elsewhere:
    """Workers of another machine, where the folder of work is another."""

    count = 1

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @contextmanager
    def map(self, job, units):
        there = Job(*pickle.loads(outgoing((job.start, job.settings))))
        with ThisProcess().map(there, units) as outcomes, chdir(self.folder):
            yield iter(list(outcomes))


def test_a_relative_folder_is_found_by_workers_elsewhere(stores, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").mkdir()
    make_dataset(Path("D"), PLAN, DatasetOptions.of("sirst"), lambda _: stores, workers=Elsewhere(tmp_path / "there"))
    assert not list(dataset_writing.problems(tmp_path / "D"))
    assert not any((tmp_path / "there").iterdir())


@pytest.mark.parametrize("workers", [None, ThisProcess()])
def test_a_signal_leaves_the_scenes_that_are_done(stores, tmp_path, workers):
    def stop(done: int, _: int) -> None:
        if done == 2:
            os.kill(os.getpid(), signal.SIGTERM)

    with pytest.raises(Interrupted, match=r"stopped after 2 of 4 scenes, kept in .*D\.partial; run the same again with resume"):
        make_dataset(tmp_path / "D", PLAN, DatasetOptions.of("coco"), lambda _: stores, workers=workers, progress=stop)
    seen: list[int] = []
    make_dataset(tmp_path / "D", PLAN, DatasetOptions.of("coco"), lambda _: stores, resume=True, progress=lambda done, _: seen.append(done))
    assert seen == [2, 3, 4]
