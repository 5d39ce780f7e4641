"""Who works: this process, processes of this machine, or a Dask cluster. All hand back the same rows, chunk by chunk.

Which rows are a chunk is the plan's to say, not the workers', so that numbers do not depend on how many there are.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, TypeVar

from gearmesh.errors import ArgumentError, OutputArgumentError, OutputError
from gearmesh.files.reading import is_file

T = TypeVar("T")
Work = Callable[[list[Any]], T]
#: the number of a chunk, and its rows
Chunk = tuple[int, list[Any]]

#: chunks that wait beside those in work, for each worker: so many that none is idle, so few that 10^5 do not fill memory
AHEAD = 3
#: how often a chunk whose worker died is given to another
RETRIES = 3
#: files of TLS settings, and their names in Dask
TLS = {"ca_file": "tls_ca_file", "client_cert": "tls_client_cert", "client_key": "tls_client_key"}
#: seconds to wait for a scheduler
PATIENCE = 10


def in_process(work: Work[T], chunks: Iterable[Chunk]) -> Iterator[tuple[int, T]]:
    """Chunks one after the other."""
    for number, rows in chunks:
        yield number, work(rows)


def on_processes(work: Work[T], chunks: Iterable[Chunk], workers: int) -> Iterator[tuple[int, T]]:
    """Chunks on so many processes of this machine, as they are finished; they end with this one, however that ends, and at once
    where nobody waits for them any more.

    Raises OutputError where one of them dies: what it had in work is not done.
    """
    from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import active_children, get_context

    waiting: dict[Future[T], int] = {}
    left = iter(chunks)
    spawned, others = get_context("spawn"), active_children()
    with _one_thread_each(), ProcessPoolExecutor(workers, mp_context=spawned, initializer=_end_with_parent) as pool:
        try:
            while True:
                with _deaf_to_stops():
                    for number, rows in _some(left, workers * AHEAD - len(waiting)):
                        waiting[pool.submit(work, rows)] = number
                if not waiting:
                    return
                done = wait(waiting, return_when=FIRST_COMPLETED).done
                for future in done:
                    yield waiting.pop(future), future.result()
        except BrokenProcessPool:
            raise OutputError(
                reason="a worker process died (out of memory?); run the same command again to continue"
            ) from None
        except BaseException:
            # what they have in work is lost as well if it is waited for
            for process in active_children():
                if process not in others:
                    process.terminate()
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _deaf_to_stops() -> Iterator[None]:
    """Processes that start meanwhile never hear of Ctrl-C, which a terminal sends to all: this one ends them.

    They would answer with a traceback each while they load, and with nothing while they compute in C.
    """
    import signal
    from multiprocessing import resource_tracker

    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    # that of multiprocessing itself lets signals through again once it has started
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end_with_parent() -> None:
    """In a process that another one began: end when that has ended, also by a signal that nobody can catch.

    The sentinel is the end of a pipe, on Windows a handle, that the system closes then. A worker that waits for rows would not
    notice: the pipe that it waits at is held open by its siblings, as theirs is by it.
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
    """The address of a Dask scheduler, and the files of its TLS settings by their names in TLS.

    Without files those count that the configuration of Dask has (distributed.comm.tls).
    """

    address: str
    tls: Mapping[str, str | os.PathLike[str]] | None = None

    def __post_init__(self) -> None:
        if self.tls is None:
            return
        wrong = {*self.tls} ^ {*TLS}
        if wrong:
            raise ArgumentError(
                "tls", entry=min(wrong), reason="missing or unknown", must_be=f"all of {', '.join(TLS)}"
            )
        if not self.address.startswith("tls://"):
            raise ArgumentError("scheduler", self.address, must_be="an address that begins with tls://, to go with tls")
        for name, file in self.tls.items():
            if not is_file(file):
                raise ArgumentError("tls", file, entry=name, reason="there is no such file")

    def security(self, distributed: Any) -> Any:
        """The settings as Dask takes them, None for those of its configuration."""
        if self.tls is None:
            return None
        files = {TLS[name]: os.fspath(file) for name, file in self.tls.items()}
        return distributed.Security(require_encryption=True, **files)


def on_dask(work: Work[T], chunks: Iterable[Chunk], scheduler: Scheduler) -> Iterator[tuple[int, T]]:
    """Chunks on the workers of a Dask scheduler, as they are finished; those of a worker that dies go to another.

    Raises OutputError where Dask is not installed, no scheduler answers, or a chunk has killed several workers.
    """
    distributed, address = require_dask(), scheduler.address
    try:
        security = scheduler.security(distributed)
        client = distributed.Client(address, timeout=PATIENCE, set_as_default=False, security=security)
    except (OSError, ValueError, TimeoutError, TypeError, RuntimeError) as error:
        raise OutputArgumentError(
            "scheduler", address, reason=f"no Dask scheduler answers there ({_words(error)})"
        ) from None
    left = iter(chunks)
    with client:
        numbers: dict[Any, int] = {}
        finished = distributed.as_completed(loop=client.loop)

        def more() -> None:
            room = max(sum(client.nthreads().values()), 1) * AHEAD - len(numbers)
            for number, rows in _some(left, room):
                # the work is small and goes with every chunk: data that one worker holds would be lost with it
                future = client.submit(_apply, work, rows, pure=False, retries=RETRIES)
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


def _apply(work: Work[T], rows: list[Any]) -> T:
    return work(rows)


def require_dask() -> Any:
    """The module `distributed`. Raises OutputError naming what to install."""
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
    """Processes that start meanwhile do linear algebra on one thread: there is one of them for every core."""
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
