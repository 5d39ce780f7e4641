"""Runners of chunks: this process, processes of this machine, or a Dask cluster. All return the same rows.

The plan divides rows into chunks, not the workers. Results therefore do not depend on the number of workers.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeVar

from gearmesh.errors import ArgumentError, OutputArgumentError, OutputError
from gearmesh.files.reading import is_file
from gearmesh.memory import keep_memory
from gearmesh.records import dataclass

ItemT = TypeVar("ItemT")
Work = Callable[[list[Any]], ItemT]
#: the number of a chunk, and its rows
Chunk = tuple[int, list[Any]]

#: chunks that wait for each worker: enough to keep it busy, few enough that 10^5 chunks do not fill the memory
WAITING_CHUNKS_PER_WORKER = 3
#: limit of the times that a chunk is given to another worker after its worker died
MAX_CHUNK_RETRIES = 3
#: names of TLS_OPTIONS files in options of this program, with their names in Dask
TLS_OPTIONS = {"ca_file": "tls_ca_file", "client_cert": "tls_client_cert", "client_key": "tls_client_key"}
#: address of a scheduler: protocol, if any, host and port
ADDRESS_PATTERN = re.compile(r"(?:[a-z]+://)?(?:\[[0-9a-fA-F:.%]+\]|[^\s:/\[\]]+):[0-9]{1,5}")
#: time to wait for a scheduler, s
SCHEDULER_TIMEOUT_S = 10


#: function that yields the numbers and results of chunks in the order in which they finish
Run = Callable[[Work[ItemT], Iterable[Chunk]], Iterator[tuple[int, ItemT]]]


@contextmanager
def runner(workers: int, scheduler: Scheduler | None = None) -> Iterator[Run[Any]]:
    """Yield the function that computes chunks: in this process, on `workers` processes, or on a Dask cluster.

    It may be called several times; processes and connection stay until the context ends.
    """
    if scheduler is not None:
        with _cluster(scheduler) as run:
            yield run
    elif workers > 1:
        with _processes(workers) as run:
            yield run
    else:
        yield in_process


def in_process(work: Work[ItemT], chunks: Iterable[Chunk]) -> Iterator[tuple[int, ItemT]]:
    """Yield the results of chunks, one after the other, in this process."""
    for number, rows in chunks:
        yield number, work(rows)


@contextmanager
def _processes(workers: int) -> Iterator[Run[Any]]:
    """Yield the function that computes chunks on `workers` processes of this machine.

    The processes end with this process, however it ends. They end at once if the context ends by an error. Raises
    OutputError if a process dies; its chunks are then not done.
    """
    from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import active_children, get_context

    spawned, earlier_processes = get_context("spawn"), active_children()
    with _one_thread_each(), ProcessPoolExecutor(workers, mp_context=spawned, initializer=_begin_worker) as pool:

        def run(work: Work[Any], chunks: Iterable[Chunk]) -> Iterator[tuple[int, Any]]:
            waiting: dict[Future[Any], int] = {}
            left = iter(chunks)
            while True:
                with _deaf_to_stops():
                    for number, rows in _some(left, workers * WAITING_CHUNKS_PER_WORKER - len(waiting)):
                        waiting[pool.submit(work, rows)] = number
                if not waiting:
                    return
                done = wait(waiting, return_when=FIRST_COMPLETED).done
                for future in done:
                    yield waiting.pop(future), future.result()

        try:
            yield run
        except BrokenProcessPool:
            raise OutputError(
                reason="a worker process died (out of memory?); run the same command again to continue"
            ) from None
        except BaseException:
            # the chunks in work are lost in any case: waiting for them would only cost time
            for process in active_children():
                if process not in earlier_processes:
                    process.terminate()
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _deaf_to_stops() -> Iterator[None]:
    """Let processes that start in this context ignore Ctrl-C, which a terminal sends to all; this process ends them.

    Otherwise each would print a traceback while it loads, and would not react while it computes in C.
    """
    import signal
    from multiprocessing import resource_tracker

    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    # the process of multiprocessing itself lets signals through again once it has started
    resource_tracker.ensure_running()
    blocked_before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked_before)


def _begin_worker() -> None:
    """Prepare a worker process: it keeps its memory, and ends with its parent."""
    keep_memory()
    _end_with_parent()


def _end_with_parent() -> None:
    """End a child process when its parent has ended, even by a signal that cannot be caught.

    The sentinel of the parent is the end of a pipe (a handle on Windows) that the system closes when the parent ends. A
    worker that waits for rows would not notice: its siblings hold the other end of its pipe open.
    """
    from multiprocessing import connection, parent_process
    from threading import Thread

    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        connection.wait([parent.sentinel])
        os._exit(1)

    Thread(target=watch, daemon=True).start()


@dataclass(frozen=True)
class Scheduler:
    """Address of a Dask scheduler, with its TLS_OPTIONS files by their names in TLS_OPTIONS.

    Without files, the configuration of Dask (distributed.comm.tls) applies.
    """

    address: str
    tls: Mapping[str, str | os.PathLike[str]] | None = None

    def __post_init__(self) -> None:
        if not self.address.startswith("inproc://") and not ADDRESS_PATTERN.fullmatch(self.address):
            # Dask would wait for such an address
            raise ArgumentError("scheduler", self.address, must_be="an address with a port, as tcp://host:8786")
        if self.tls is None:
            return
        wrong = {*self.tls} ^ {*TLS_OPTIONS}
        if wrong:
            raise ArgumentError(
                "tls", entry=min(wrong), reason="missing or unknown", must_be=f"all of {', '.join(TLS_OPTIONS)}"
            )
        if not self.address.startswith("tls://"):
            raise ArgumentError("scheduler", self.address, must_be="an address that begins with tls://, to go with tls")
        for name, file in self.tls.items():
            if not is_file(file):
                raise ArgumentError("tls", file, entry=name, reason="there is no such file")

    @staticmethod
    def at(address: str | None, tls: Mapping[str, str | os.PathLike[str]] | None) -> Scheduler | None:
        """Return the scheduler at an address; None without one. Raises ArgumentError for files without an address."""
        if address is None and tls is not None:
            raise ArgumentError("tls", reason="needs a scheduler")
        return None if address is None else Scheduler(address, tls)

    def security(self, distributed: Any) -> Any:
        """Return the settings for Dask; None if its configuration applies."""
        if self.tls is None:
            return None
        files = {TLS_OPTIONS[name]: os.fspath(file) for name, file in self.tls.items()}
        return distributed.Security(require_encryption=True, **files)


@contextmanager
def _cluster(scheduler: Scheduler) -> Iterator[Run[Any]]:
    """Yield the function that computes chunks on a Dask cluster.

    Chunks of a worker that dies go to another worker. Raises OutputError if Dask is not installed, no scheduler
    answers, or a chunk has killed several workers.
    """
    distributed, address = require_dask(), scheduler.address
    try:
        security = scheduler.security(distributed)
        client = distributed.Client(address, timeout=SCHEDULER_TIMEOUT_S, set_as_default=False, security=security)
    except (OSError, ValueError, TimeoutError, TypeError, RuntimeError) as error:
        raise OutputArgumentError(
            "scheduler", address, reason=f"no Dask scheduler answers there ({_words(error)})"
        ) from None

    def run(work: Work[Any], chunks: Iterable[Chunk]) -> Iterator[tuple[int, Any]]:
        left = iter(chunks)
        numbers: dict[Any, int] = {}
        finished = distributed.as_completed(loop=client.loop)

        def more() -> None:
            room = max(sum(client.nthreads().values()), 1) * WAITING_CHUNKS_PER_WORKER - len(numbers)
            for number, rows in _some(left, room):
                # the work is small and is sent with each chunk: data held by one worker would be lost with it
                future = client.submit(_apply, work, rows, pure=False, retries=MAX_CHUNK_RETRIES)
                numbers[future.key] = number
                finished.add(future)

        more()
        for future in finished:
            try:
                result = future.result()
            except distributed.KilledWorker:
                raise OutputError(
                    reason="a chunk killed several Dask workers; run the same command again to continue"
                ) from None
            except (RuntimeError, ImportError, distributed.CancelledError) as error:
                raise OutputArgumentError(
                    "scheduler",
                    address,
                    reason=f"the scheduler stopped, or it or a worker has another version of gearmesh ({_words(error)})",
                ) from None
            yield numbers.pop(future.key), result
            more()

    with client:
        yield run


def _apply(work: Work[ItemT], rows: list[Any]) -> ItemT:
    """Return the result of a chunk, in a worker of Dask."""
    keep_memory()
    return work(rows)


def require_dask() -> Any:
    """Return the module `distributed`. Raises OutputError naming what to install."""
    try:
        import distributed
    except ImportError:
        raise OutputArgumentError("scheduler", reason='Dask is not installed: pip install "gearmesh[study]"') from None
    return distributed


def _some(left: Iterator[Chunk], count: int) -> Iterator[Chunk]:
    for _ in range(count):
        following = next(left, None)
        if following is None:
            return
        yield following


def _words(error: BaseException) -> str:
    return " ".join(str(error).split())[:120]


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let processes that start in this context do linear algebra on one thread: each core has one process."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    before = {name: os.environ.get(name) for name in names}
    os.environ.update(dict.fromkeys(names, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
