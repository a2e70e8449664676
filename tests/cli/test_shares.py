"""Shares of a sequence on the command line, and the end that checks and names it."""

from __future__ import annotations

import sys
from hashlib import sha256

import pytest


def files(store):
    found = sorted(path for path in store.rglob("*") if path.is_file())
    return {str(path.relative_to(store)): sha256(path.read_bytes()).hexdigest() for path in found}


@pytest.fixture(autouse=True)
def stand_in(pipeline):
    """No scene is computed here."""


def test_shares_then_finish_are_the_run_in_one_go(seaglint, scenario, tmp_path):
    store = tmp_path / "b.zarr"
    assert seaglint("render", scenario, "-o", tmp_path / "a.zarr", "--progress", "none").code == 0
    assert "share 1/2 is done; " in seaglint("render", scenario, "-o", store, "--shard", "1/2", "--progress", "none").err
    early = seaglint("render", "--finish", store)
    assert (early.code, "frames are missing: 0" in early.err, "(of shares 0/2)" in early.err) == (2, True, True)
    last = seaglint("render", scenario, "-o", store, "--shard", "0/2", "--progress", "none")
    assert last.code == 0
    assert f"next: seaglint render --finish {store}" in last.err
    ended = seaglint("render", "--finish", store)
    assert (ended.code, "frames, all complete" in ended.err) == (0, True)
    assert files(store) == files(tmp_path / "a.zarr")
    for again in (("render", "--finish", store), ("render", scenario, "-o", store, "--shard", "0/2", "--progress", "none")):
        answer = seaglint(*again)
        assert (answer.code, "is finished already" in answer.err) == (0, True)


def test_finish_with_a_scenario_refuses_another(seaglint, scenario, tmp_path):
    store = tmp_path / "b.zarr"
    assert seaglint("render", scenario, "-o", store, "--shard", "0/1", "--progress", "none").code == 0
    text = scenario.read_text()
    scenario.write_text("seed = 99\n" + text)
    for command in (("--finish",), ("--shard", "0/1"), ("--resume",)):
        answer = seaglint("render", scenario, "-o", store, *command, "--progress", "none")
        assert (answer.code, "was made with another seed;" in answer.err) == (2, True), answer.err
    scenario.write_text(text)
    answer = seaglint("render", scenario, "-o", store, "--finish")
    assert (answer.code, "4 frames, all complete" in answer.err, store.is_dir()) == (0, True, True)


def test_finish_with_a_scenario_names_the_frames_that_are_missing(seaglint, scenario, tmp_path):
    store = tmp_path / "b.zarr"
    assert seaglint("render", scenario, "-o", store, "--shard", "1/2", "--progress", "none").code == 0
    answer = seaglint("render", scenario, "-o", store, "--finish")
    assert (answer.code, answer.err.count("\n"), store.exists()) == (2, 1, False)
    assert "2 of 4 frames are missing: 0, 2 (of shares 0/2); run these shares again, or all with --resume" in answer.err


def test_finish_draws_the_preview_that_shares_cannot(seaglint, scenario, tmp_path, monkeypatch):
    monkeypatch.setattr("seaglint.plot.video.video_available", lambda: False)
    monkeypatch.setattr("seaglint.plot.preview.write_picture", lambda run, path, scale: path.write_text(f"{run.sizes['time']} {scale}"))
    assert seaglint("render", scenario, "-o", tmp_path / "b.zarr", "--shard", "0/1", "--progress", "none").code == 0
    assert seaglint("render", scenario, "-o", tmp_path / "b.zarr", "--finish", "--preview", "--scale", "log").code == 0
    assert (tmp_path / "b.png").read_text() == "4 log"
    refused = seaglint("render", "--finish", "memory://runs/b.zarr", "--preview")
    assert (refused.code, "--preview writes pictures beside a folder" in refused.err) == (2, True)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--shard", "2/2"), "counted from 0"),
        (("--shard", "0/2", "--overwrite"), "joins what is there"),
        (("--shard", "0/2", "--preview"), "leave --preview out"),
        (("--finish", "--shard", "0/2"), "give one of the two"),
        (("--workers", "2", "--dask", "tcp://a:1"), "give one of them"),
    ],
)
def test_options_that_do_not_go_together_are_one_line(seaglint, scenario, tmp_path, options, told):
    answer = seaglint("render", scenario, "-o", tmp_path / "c.zarr", *options)
    assert (answer.code, answer.err.count("\n"), told in answer.err) == (2, 1, True), answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["my.toml"]


def test_a_share_over_workers_then_previews(seaglint, scenario, tmp_path, monkeypatch):
    stand_in = sys.modules[
        "seaglint.studies.sequence.render_sequence"
    ]  # the package's attribute is the true one, where that was imported before
    asked, made = [], stand_in.render

    def render(*given, workers=None, **more):
        asked.append((workers.count, workers.threads, str(more.get("share")), more["threads"]))
        return made(*given, **more)

    monkeypatch.setattr(stand_in, "render", render)
    monkeypatch.setattr("seaglint.plot.video.video_available", lambda: False)
    monkeypatch.setattr("seaglint.plot.preview.write_picture", lambda run, path, scale: path.write_text(scale))
    options = ("--workers", "2", "--threads", "1", "--progress", "none")
    assert seaglint("render", scenario, "-o", tmp_path / "b.zarr", "--shard", "0/2", *options).code == 0
    assert seaglint("render", scenario, "-o", tmp_path / "a.zarr", "--preview", *options).code == 0
    assert asked == [(2, 1, "0/2", None), (2, 1, "None", None)]
    assert (tmp_path / "a.png").exists()


def test_finish_of_nothing_and_of_a_scenario(seaglint, scenario, tmp_path):
    assert "no such unfinished sequence" in seaglint("render", "--finish", tmp_path / "none.zarr").err
    assert "which store" in seaglint("render", "--finish", scenario).err


def test_a_store_behind_a_url(seaglint, scenario):
    assert seaglint("render", scenario, "-o", "memory://runs/a.zarr", "--progress", "none").code == 0
    answer = seaglint("info", "memory://runs/a.zarr")
    assert (answer.code, "complete" in answer.out) == (0, True)
