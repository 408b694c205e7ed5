"""Batches: every file with every setting, on processes or a cluster, logged, stopped and gone on with."""

import csv
import multiprocessing
import threading
from pathlib import Path

import distributed
import psutil
import pytest

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import CodecError, FormatError
from qmd_studio.formats.asf_write import write_asf
from qmd_studio.registry import encode_motion
from qmd_studio.tuning.batch import Job, run_job, run_jobs
from qmd_studio.tuning.batch_folder import BatchFolder
from qmd_studio.tuning.session import TuningSession
from tests.generated_motion import walker

SETTINGS = (QmdSettings(), QmdSettings(0, 9, 30, Encoder.PAPER))


@pytest.fixture
def walks(tmp_path: Path) -> list[Path]:
    folder = tmp_path / "walks"
    folder.mkdir()
    paths = [folder / f"walk{seed}.npz" for seed in range(3)]
    for seed, path in enumerate(paths):
        path.write_bytes(encode_motion(".npz", walker(60, seed=seed)))
    return paths


def jobs_of(paths, settings=SETTINGS):
    return [Job(path, settings) for path in paths]


def test_a_row_says_what_the_lab_says(walks):
    result = run_job(Job(walks[0], SETTINGS))
    assert result.error is None
    session = TuningSession(walker(60, seed=0))
    for row, settings in zip(result.rows, SETTINGS, strict=True):
        report = session.evaluate(settings)
        assert (row["fdf"], row["bits"], row["segment"]) == (settings.fdf, settings.bits, settings.segment)
        assert (row["bytes"], row["encoder"]) == (report.size.bytes, str(settings.encoder))
        assert row["def"] == pytest.approx(report.error.def_, rel=1e-3)


def test_processes_do_every_job_and_end(walks):
    results = list(run_jobs(jobs_of(walks), n_jobs=2))
    assert sorted(result.job.path for result in results) == walks
    assert all(len(result.rows) == 2 for result in results)
    assert not multiprocessing.active_children()


def test_a_batch_that_is_stopped_ends_its_processes(walks):
    stop = threading.Event()
    results = []
    for result in run_jobs(jobs_of(walks * 10), n_jobs=2, cancel=stop):
        results.append(result)
        stop.set()
    assert 0 < len(results) < 30
    assert not multiprocessing.active_children()


def test_a_file_that_cannot_be_read_is_told_and_the_others_are_done(walks, tmp_path):
    bad = tmp_path / "bad.bvh"
    bad.write_text("HIERARCHY\nROOT hips\n{\n")
    results = {result.job.path: result for result in run_jobs(jobs_of([bad, walks[0]]), n_jobs=1)}
    assert "bad.bvh" in results[bad].error
    assert results[bad].log[-1].startswith("error: ")
    assert results[walks[0]].error is None


def test_a_skeleton_is_taken_where_an_amc_has_none(tmp_path):
    motion = walker(40)
    amc = tmp_path / "walk.amc"
    amc.write_bytes(encode_motion(".amc", motion))
    asf = tmp_path / "bones" / "other.asf"
    asf.parent.mkdir()
    asf.write_bytes(write_asf(motion.skeleton))
    assert run_job(Job(amc, SETTINGS)).error
    assert run_job(Job(amc, SETTINGS, asf)).error is None


def test_the_folder_holds_a_table_and_a_log_for_each_file(walks, tmp_path):
    folder = BatchFolder(tmp_path / "out")
    for job in jobs_of(walks):
        folder.add(run_job(job))
    with folder.table.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["file"] for row in rows] == [str(path) for path in walks for _ in SETTINGS]
    assert {"bytes", "def", "mean_mm", "max_mm", "kbit_s"} <= rows[0].keys()
    logs = sorted((tmp_path / "out" / "logs").iterdir())
    assert len(logs) == 3
    assert logs[0].read_text().splitlines()[-1] == "done"


def test_only_what_is_missing_is_done_again(walks, tmp_path):
    folder = BatchFolder(tmp_path / "out")
    jobs = jobs_of(walks)
    folder.add(run_job(jobs[0]))
    again = BatchFolder(tmp_path / "out")
    assert again.missing(jobs) == jobs[1:]
    more = (*SETTINGS, QmdSettings(12))
    assert [job.settings for job in again.missing(jobs_of(walks[:1], more))] == [more[2:]]
    again.add(run_job(Job(walks[0], more[2:])))
    assert not BatchFolder(tmp_path / "out").missing(jobs_of(walks[:1], more))


def test_a_file_that_has_changed_is_done_anew(walks, tmp_path):
    folder = BatchFolder(tmp_path / "out")
    folder.add(run_job(Job(walks[0], SETTINGS)))
    walks[0].write_bytes(encode_motion(".npz", walker(61)))
    (job,) = folder.missing(jobs_of(walks[:1]))
    folder.add(run_job(job))
    assert {row["frames"] for row in folder.rows} == {61}
    assert len(folder.rows) == 2


@pytest.mark.parametrize("text", ["{", "{}", '{"rows": [3]}', '{"rows": [{}]}'])
def test_a_damaged_folder_is_refused(tmp_path, text):
    (tmp_path / "batch.json").write_text(text)
    with pytest.raises(FormatError, match="saved batch"):
        BatchFolder(tmp_path)


def test_a_real_cluster_does_the_same_jobs(walks):
    with distributed.LocalCluster("127.0.0.1", n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        assert cluster.scheduler_address.startswith("tcp://127.0.0.1:")
        workers = [psutil.Process(nanny.pid) for nanny in cluster.workers.values()]
        assert {place for process in (psutil.Process(), *workers) for place in _listens_at(process)} == {"127.0.0.1"}
        there = list(run_jobs(jobs_of(walks), cluster=cluster.scheduler_address))
    assert len(workers) == 2
    assert not psutil.wait_procs(workers, timeout=10)[1]
    here = {result.job.path: result.rows for result in map(run_job, jobs_of(walks))}
    assert len(there) == 3
    for result in there:
        assert [row["def"] for row in result.rows] == [row["def"] for row in here[result.job.path]]


def _listens_at(process):
    return [entry.laddr.ip for entry in process.net_connections("tcp") if entry.status == psutil.CONN_LISTEN]


def test_a_cluster_out_of_reach_is_an_error_with_the_next_step(walks):
    with pytest.raises(CodecError) as caught:
        list(run_jobs(jobs_of(walks), cluster="nonsense://"))
    assert caught.value.hint
