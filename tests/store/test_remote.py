"""Sequences in an object store: a marker says what is unfinished, since nothing can be renamed there."""

from __future__ import annotations

import gc
import json
import sys
import uuid

import fsspec
import numpy as np
import pytest
import zarr
from toy_store import frame, layout, pixels

from seaglint.base.errors import BackendError, DataError, StorageError
from seaglint.store.location import Local, place_of
from seaglint.store.sequence_store import finish_sequence, open_sequence, write_sequence
from seaglint.store.writers import Share
from seaglint.studies.file_contents import describe


@pytest.fixture
def url() -> str:
    return f"memory://{uuid.uuid4().hex}/run.zarr"


def check_whole(output: str) -> None:
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"], np.stack([pixels(n) for n in range(23)]))
        assert "unfinished" not in found.attrs
    facts = describe(output)
    assert facts.frames is not None
    assert (facts.frames.frames_done, facts.frames.complete) == (23, True)
    assert facts.bytes > 1000


def write_in_all_ways(output: str) -> None:
    """In one go, resumed, in shares, with a frame damaged."""
    write_sequence(output, layout(), frame)
    check_whole(output)
    with pytest.raises(DataError, match="exists already"):
        write_sequence(output, layout(), frame)
    write_sequence(output, layout(), frame, share=Share(0, 2))  # is there already
    assert not finish_sequence(output)

    def crash(number: int):
        if number == 9:
            raise RuntimeError("a defect")
        return frame(number)

    with pytest.raises(RuntimeError):
        write_sequence(output, layout(), crash, overwrite=True)
    with pytest.raises(DataError, match="is unfinished, 14 of 23 frames are missing"):
        open_sequence(output)
    with pytest.raises(DataError, match="go on with resume=True"):
        write_sequence(output, layout(), frame)
    with pytest.raises(DataError, match=r"14 of 23 frames are missing: 9-22"):
        finish_sequence(output)
    zarr.open_group(output, mode="r+")["radiance"][2, 0, 0] = -1.0
    asked = []
    write_sequence(output, layout(), lambda n: (asked.append(n), frame(n))[1], resume=True)
    assert asked == [2, *range(9, 23)]
    check_whole(output)
    second = output.replace("run.zarr", "shares.zarr")
    for index in (1, 0):
        write_sequence(second, layout(), frame, share=Share(index, 2))
    with pytest.raises(DataError, match="all frames are there; complete it"):
        open_sequence(second)
    assert finish_sequence(second)
    check_whole(second)


def test_a_sequence_in_memory(url):
    write_in_all_ways(url)
    files = fsspec.filesystem("memory")
    root = url.removeprefix("memory:/").removesuffix("/run.zarr")
    one, two = (
        {path.removeprefix(f"{root}/{name}"): files.cat_file(path) for path in files.find(f"{root}/{name}")}
        for name in ("run.zarr", "shares.zarr")
    )
    assert one == two
    assert "unfinished" not in json.loads(one["/zarr.json"])["attributes"]


def test_a_start_that_was_cut_is_made_anew(url):
    zarr.open_group(url, mode="w", attributes={"seaglint_format": "seaglint-sequence-1", "unfinished": {"made": False}})
    write_sequence(url, layout(), frame, resume=True)
    check_whole(url)


def test_urls_of_files_are_folders_and_unknown_ones_are_refused(tmp_path, monkeypatch):
    assert place_of(f"file://{tmp_path}/run.zarr") == Local(tmp_path / "run.zarr")
    with pytest.raises(DataError, match="no kind of place that is known"):
        place_of("nix://a/run.zarr")
    monkeypatch.setattr(fsspec, "get_filesystem_class", lambda name: (_ for _ in ()).throw(ImportError("Install s3fs to access S3")))
    with pytest.raises(BackendError, match=r"s3:// needs s3fs.*pip install 's3fs>=2024\.9'"):
        place_of("s3://bucket/run.zarr")


@pytest.mark.parametrize(
    ("url", "match"),
    [
        ("s3://bucket/run.zarr", r"s3:// needs s3fs.*pip install 's3fs>=2024\.9'"),
        ("gs://bucket/run.zarr", "gs:// needs fsspec, which is not installed; pip install fsspec"),
    ],
)
def test_without_fsspec_the_message_names_what_is_missing(url, match, monkeypatch):
    monkeypatch.setitem(sys.modules, "fsspec", None)
    with pytest.raises(BackendError, match=match):
        place_of(url)


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore::ResourceWarning")
def test_a_sequence_in_a_bucket(monkeypatch):
    server = pytest.importorskip("moto.server").ThreadedMotoServer(port=0)
    pytest.importorskip("s3fs")
    server.start()
    try:
        host, port = server.get_host_and_port()
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{host}:{port}")
        monkeypatch.setenv("AWS_ACCESS_KEY_ID", "test")
        monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "test")
        monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
        fsspec.filesystem("s3").mkdir("sea")
        write_in_all_ways("s3://sea/run.zarr")
        with pytest.raises(StorageError, match="cannot be reached"):
            write_sequence("s3://nowhere/run.zarr", layout(), frame)
    finally:
        fsspec.get_filesystem_class("s3").clear_instance_cache()
        server.stop()
        gc.collect()  # s3fs leaves open sessions to the collector, whose warning belongs to no later test
