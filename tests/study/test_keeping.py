"""Rows that are kept: killed and gone on with, on any number of workers, on a Dask cluster that loses one."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.places import ROOT, SAMPLES

import gearmesh as gm
from gearmesh import OutputError
from gearmesh.study.rows import work as work_module

CROSSED = SAMPLES / "beveloid_crossed.toml"
#: 250 rows in 5 chunks
WORDS = ("study", CROSSED, "--sample", "250", "--seed", "3", "--record", "path", "--no-pictures",
         "--tolerance", "assembly.dx=normal:0:20um", "--tolerance", "assembly.gamma_h=uniform:-0.05:0.05")  # fmt: skip
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The study in one go, in this process."""
    out = tmp_path_factory.mktemp("whole") / "out"
    assert run(*WORDS, "--workers", "1", "-o", out)[0] == 0
    return out


def chunks(out: Path) -> list[int]:
    """Numbers of the chunks that are kept, as they stand in the file."""
    return [json.loads(line)["done"][0] for line in (out / "rows.jsonl").read_text().splitlines()]


#: hundredths of a second of CPU time in which a worker has begun to load, and has not ended
LOADING = 20
#: seconds after which something that never comes is given up: no load of a machine makes it so late
NEVER_S = 900.0
#: the command with words of its own, which waits for a line when it has kept rows, so that no process is ahead of another
HELD = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # of a job in the background it is ignored
from gearmesh.study.store import StudyStore
keep = StudyStore.add
def add(store, chunk, rows):
    if {kept}:
        keep(store, chunk, rows)
    print("held", flush=True)
    sys.stdin.readline()
    if not {kept}:
        keep(store, chunk, rows)
StudyStore.add = add
sys.argv[0] = "gearmesh"
from gearmesh.__main__ import main
sys.exit(main())
"""


def held_study(out: Path, *more: str, kept: bool = True, **pipes: Any) -> subprocess.Popen[str]:
    """A study in a process of its own, held as soon as the rows of a chunk are kept, or before they are."""
    command = [sys.executable, "-c", HELD.format(kept=kept), *map(str, WORDS), *more, "-o", str(out)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL, **pipes}
    return subprocess.Popen(command, env=ENVIRONMENT, text=True, **pipes)


def is_held(process: subprocess.Popen[str]) -> bool:
    assert process.stdout is not None
    return process.stdout.readline() == "held\n"


def children(process: subprocess.Popen[str]) -> list[int]:
    return [int(own) for own in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]


def ticks(process: int) -> int:
    """CPU time that a process has taken, in hundredths of a second."""
    return sum(map(int, Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13]))


def alive(process: int) -> bool:
    """True for a process that has not ended."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.sweep
@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_stopped_it_ends_at_once_with_one_line(tmp_path: Path, number: int, status: int) -> None:
    """Ctrl-C goes to all processes of a terminal: even while the workers load they say nothing of their own, and nobody waits for
    what they have in work."""
    out = tmp_path / "out"
    with held_study(out, "--workers", "2", kept=False, stderr=subprocess.PIPE, start_new_session=True) as process:
        until = time.monotonic() + NEVER_S
        while min(map(ticks, begun := children(process)[1:]), default=0) < LOADING or len(begun) < 2:
            assert process.poll() is None
            assert time.monotonic() < until
            time.sleep(0.005)
        os.killpg(process.pid, number)
        _, said = process.communicate(timeout=NEVER_S)
    assert process.returncode == status
    assert said.splitlines() == [f"gearmesh: error: stopped: kept in {out}, each of them whole: plan.json"]
    assert [own for own in begun if alive(own)] == []


@pytest.mark.sweep
def test_killed_it_goes_on_where_it_was(whole: Path, tmp_path: Path) -> None:
    """On two workers, which end with it, though nothing tells them to: they wait for rows for as long as the machine runs."""
    out = tmp_path / "out"
    with held_study(out, "--workers", "2") as process:
        assert is_held(process)
        begun = children(process)
        process.send_signal(signal.SIGKILL)
    assert len(begun) >= 2
    until = time.monotonic() + NEVER_S
    while left := [process for process in begun if alive(process)]:
        assert time.monotonic() < until, left
        time.sleep(0.05)
    before = chunks(out)
    assert len(before) == 1
    # a line that was being written, one byte short, and one that the disk spoiled
    line = (whole / "rows.jsonl").read_bytes().splitlines(keepends=True)[-1]
    with open(out / "rows.jsonl", "ab") as file:
        file.write(line[:-1])
    assert run(*WORDS, "--workers", "1", "-o", out)[0] == 0
    assert chunks(out)[: len(before)] == before
    assert sorted(chunks(out)) == list(range(5))
    for name in ("study.csv", "study.json"):
        assert (out / name).read_bytes() == (whole / name).read_bytes()
    spoiled = line.replace(b"0.0", b"0.1", 1)
    (out / "rows.jsonl").write_bytes(
        b"".join(
            spoiled if own == line else own for own in (whole / "rows.jsonl").read_bytes().splitlines(keepends=True)
        )
    )
    assert run(*WORDS, "--workers", "1", "-o", out)[0] == 0
    assert (out / "study.csv").read_bytes() == (whole / "study.csv").read_bytes()


def test_rows_are_the_same_in_chunks_of_any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows of small studies go in chunks of fifty, of large ones in chunks of 120 to 400."""
    gears = gm.build(gm.load(CROSSED))
    tolerance = {"assembly.dx": "normal:0:20um", "assembly.gamma_h": "uniform:-0.05:0.05"}
    together = gears.study(sample=30, seed=3, tolerance=tolerance, record="path", workers=1)
    work = together._work
    assert [work.chunk_rows(rows) for rows in (30, 240, 1_600, 3_200, 100_000)] == [50, 60, 120, 200, 400]
    monkeypatch.setattr(work_module, "MIN_BATCHED_ROWS", 7)
    apart = gears.study(sample=30, seed=3, tolerance=tolerance, record="path", workers=1)
    for name, values in together.columns.items():
        if isinstance(values[0], float):
            np.testing.assert_allclose(apart.columns[name], values, rtol=1e-11, atol=1e-11)


@pytest.mark.sweep
def test_another_plan_in_the_same_folder_is_refused(whole: Path) -> None:
    for more in (["--seed", "4"], ["--set", "pinion.teeth=26"], ["--record", "cycle"]):
        assert refused(*WORDS, *more, "-o", whole) == (
            f"{whole}: holds another study (design, plan, record or version differ); name another folder"
        )


@pytest.mark.sweep
def test_two_processes_do_not_work_on_one_study(whole: Path) -> None:
    from gearmesh.study.store import StudyStore

    plan = json.loads((whole / "plan.json").read_text())
    with StudyStore(whole, plan).open() as store:
        assert sorted(store.chunks) == list(range(5))
        with (
            pytest.raises(OutputError, match="another process is working on this study"),
            StudyStore(whole, plan).open(),
        ):
            pass


@pytest.mark.sweep
def test_numbers_do_not_depend_on_the_workers(whole: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert run(*WORDS, "--workers", "2", "-o", out)[0] == 0
    assert (out / "study.csv").read_bytes() == (whole / "study.csv").read_bytes()


@pytest.mark.sweep
def test_a_local_cluster_finds_the_same(whole: Path, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster:
        status, _, told = run(*WORDS, "--scheduler", cluster.scheduler_address, "-o", tmp_path / "out")
    assert status == 0, told
    assert (tmp_path / "out" / "study.csv").read_bytes() == (whole / "study.csv").read_bytes()


@pytest.mark.sweep
def test_a_cluster_that_loses_a_worker_finds_the_same(whole: Path, tmp_path: Path) -> None:
    """A scheduler and two workers as processes on loopback; one is killed with rows in work."""
    pytest.importorskip("distributed")
    dask = [sys.executable, "-m", "dask"]
    file, started = tmp_path / "scheduler.json", []

    def start(*words: str) -> subprocess.Popen[bytes]:
        process = subprocess.Popen(
            [*dask, *words, "--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(file)],
            env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        started.append(process)
        return process

    try:
        start("scheduler", "--port", "0")
        workers = [
            start("worker", "--nthreads", "1", "--no-nanny", "--local-directory", str(tmp_path / f"w{k}"))
            for k in (0, 1)
        ]
        until = time.monotonic() + NEVER_S
        while not file.exists() or not file.read_text().strip():
            assert time.monotonic() < until
            time.sleep(0.05)
        address = json.loads(file.read_text())["address"]
        from distributed import Client

        with Client(address, set_as_default=False, timeout=NEVER_S) as client:
            client.wait_for_workers(2, timeout=NEVER_S)
        out = tmp_path / "out"
        with held_study(out, "--scheduler", address) as study:
            assert is_held(study)
            assert len(chunks(out)) == 1
            workers[0].kill()
            study.communicate("\n" * 5, timeout=NEVER_S)
            assert study.returncode == 0
    finally:
        for process in started:
            process.kill()
            process.wait()
    assert sorted(chunks(out)) == list(range(5))
    assert (out / "study.csv").read_bytes() == (whole / "study.csv").read_bytes()


@pytest.mark.parametrize(
    ("missing", "more"), [("distributed", ["--scheduler", "tcp://127.0.0.1:1"]), ("pyarrow", ["--parquet"])]
)
def test_what_is_not_installed_is_named(missing: str, more: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    said = refused(*WORDS, *more)
    assert 'not installed: pip install "gearmesh[study]"' in said
    assert "\n" not in said


@pytest.mark.sweep
def test_a_scheduler_that_is_not_there_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("gearmesh.study.runners.SCHEDULER_TIMEOUT_S", 0.5)
    assert "--scheduler = tcp://127.0.0.1:9: no Dask scheduler answers there" in refused(
        *WORDS, "--scheduler", "tcp://127.0.0.1:9"
    )


def certificates(folder: Path) -> dict[str, Path]:
    """Files of an authority and of a certificate that it has signed."""
    if shutil.which("openssl") is None:
        pytest.skip("openssl")

    def openssl(*words: str) -> None:
        subprocess.run(["openssl", *words], cwd=folder, check=True, capture_output=True)

    key = ["-newkey", "rsa:2048", "-nodes"]
    openssl("req", "-x509", *key, "-keyout", "ca.key", "-out", "ca.pem", "-subj", "/CN=authority", "-days", "2")
    openssl("req", *key, "-keyout", "own.key", "-out", "own.csr", "-subj", "/CN=own")
    openssl("x509", "-req", "-in", "own.csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-out", "own.pem", "-days", "2")
    return {"ca_file": folder / "ca.pem", "client_cert": folder / "own.pem", "client_key": folder / "own.key"}


@pytest.mark.sweep
def test_a_scheduler_with_tls_takes_clients_of_its_authority_alone(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr("gearmesh.study.runners.SCHEDULER_TIMEOUT_S", NEVER_S)
    (tmp_path / "other").mkdir()
    own, other = certificates(tmp_path), certificates(tmp_path / "other")
    security = distributed.Security(
        require_encryption=True,
        tls_ca_file=str(own["ca_file"]),
        **{
            f"tls_{who}_{of}": str(own[f"client_{of}"])
            for who in ("scheduler", "worker", "client")
            for of in ("cert", "key")
        },
    )
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, protocol="tls", security=security
    ) as cluster:
        address = ["--scheduler", cluster.scheduler_address]
        files = {name: [f"--tls-{name.replace('_', '-')}", str(file)] for name, file in own.items()}
        options = [word for pair in files.values() for word in pair]
        status, _, told = run(*WORDS, *address, *options, "-o", tmp_path / "out")
        assert status == 0, told
        wrong = [word for name, file in other.items() for word in (f"--tls-{name.replace('_', '-')}", str(file))]
        monkeypatch.setattr("gearmesh.study.runners.SCHEDULER_TIMEOUT_S", 1)
        for refused_options in (wrong, []):
            assert "no Dask scheduler answers there" in refused(*WORDS, *address, *refused_options)
    assert (tmp_path / "out" / "study.csv").read_bytes() == (whole / "study.csv").read_bytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--tls-ca-file", "ca.pem"], "--tls-client-cert: missing; TLS needs all three files"),
        (["--tls-ca-file", "a", "--tls-client-cert", "b", "--tls-client-key", "c"], "a: cannot be read: No such file"),
    ],
)
def test_settings_of_tls_are_complete(options: list[str], message: str) -> None:
    assert refused(*WORDS, "--scheduler", "tls://127.0.0.1:9", *options).startswith(message)


def test_settings_of_tls_go_with_an_address_of_tls(tmp_path: Path) -> None:
    file = tmp_path / "x.pem"
    file.write_text("x")
    gears, tls = gm.build(gm.load(CROSSED)), dict.fromkeys(("ca_file", "client_cert", "client_key"), file)
    with pytest.raises(gm.DesignError, match=r"^scheduler = tcp://a:1: must be an address that begins with tls://"):
        gears.study({"assembly.dx": [0.0]}, record="path", scheduler="tcp://a:1", tls=tls)
    with pytest.raises(gm.DesignError, match=r"^tls: needs a scheduler$"):
        gears.study({"assembly.dx": [0.0]}, record="path", tls=tls)
    with pytest.raises(gm.DesignError, match=r"^tls client_key: missing or unknown; must be all of ca_file, "):
        gears.study(
            {"assembly.dx": [0.0]}, record="path", scheduler="tls://a:1", tls={"ca_file": file, "client_cert": file}
        )


@pytest.mark.sweep
def test_a_study_in_memory_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    study = gm.build(gm.load(CROSSED)).study({"assembly.dx": [0.0]}, record="path")
    assert len(study.plan) == 1
    assert not list(tmp_path.iterdir())
