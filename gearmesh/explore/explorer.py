"""A running page: its address, and its end."""

from __future__ import annotations

import asyncio
import concurrent.futures
import importlib.util
import json
import socket
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from gearmesh.design.core import Design
from gearmesh.design.dotted import leaves, nested
from gearmesh.design.files import override, read, text_of, toml, with_version
from gearmesh.design.rewriting import rewritten
from gearmesh.errors import ArgumentError, OutputError
from gearmesh.explore.state import KIND_PREFIX, OPENED_NAME, Origin
from gearmesh.explore.workers import NO_PAGE, Listener, Worker
from gearmesh.formats import JSON_SUFFIX
from gearmesh.pipes import closed_pipes_raise
from gearmesh.systems.designs import parse_as_stated
from gearmesh.systems.system import try_build

if TYPE_CHECKING:
    import uvicorn

#: address of this machine
LOOPBACK_ADDRESS = "127.0.0.1"
#: smallest port that may be chosen; 0 stands for any free port
MIN_PORT = 1024
#: largest port
MAX_PORT = 65535
#: name of the extra with the server library
EXTRA_NAME = "explore"


class Explorer:
    """A page on this machine on which gears and figures follow each changed key, served until it is closed.

    Use it as a context manager, or close it. Raises DesignError or NoSolutionError if the gears cannot be built.
    """

    def __init__(
        self, opened: Origin | Callable[[], Origin | None] | None = None, port: int = 0, *, browser: bool = True
    ) -> None:
        refuse_port(port)
        require_server()
        self._socket = _bound(port)
        self.port = int(self._socket.getsockname()[1])
        self._worker, self._loop = Worker(), asyncio.new_event_loop()
        self._thread = threading.Thread(target=_run, args=(self._loop,), daemon=True)
        self._thread.start()
        # the process for heavy work loads its libraries while the design is read here
        self._begun = asyncio.run_coroutine_threadsafe(self._worker.start(), self._loop)
        try:
            origin = opened() if callable(opened) else opened
            self._begun.result()
            known = None if origin is None else Future[bool]()
            asyncio.run_coroutine_threadsafe(_opened(self._worker, origin, known), self._loop)
            import uvicorn

            from gearmesh.explore.server import MAX_FRAME_BYTES, Gate, application

            self._gate = Gate()
            app, self.pages = application(origin, self._gate, self.port, self._worker)
            config = uvicorn.Config(
                app,
                ws_max_size=MAX_FRAME_BYTES,
                log_config=None,
                access_log=False,
                server_header=False,
                proxy_headers=False,
                ws_per_message_deflate=False,
                lifespan="off",
                timeout_graceful_shutdown=1,
            )
            self._server = uvicorn.Server(config)
            self._served = asyncio.run_coroutine_threadsafe(self._server.serve([self._socket]), self._loop)
            _wait_for(self._server, self._served)
            if browser:
                # a browser starts while the gears are built
                import webbrowser

                webbrowser.open(self.url)
            if origin is not None and known is not None and not known.result():
                # the process has refused the design: the error itself is raised here
                _try_build(origin)
        except BaseException:
            self._end()
            raise

    @property
    def url(self) -> str:
        """Address of the page; its token is good once.

        Returns
        -------
        str
            With 127.0.0.1, the port and the token.

        Examples
        --------
        >>> with gears.explore(browser=False) as page:
        ...     page.url.partition(":")[0]
        'http'
        """
        return f"http://{LOOPBACK_ADDRESS}:{self.port}/?token={self._gate.token}"

    def wait(self) -> None:
        """Wait until the page is closed, or Ctrl-C.

        Examples
        --------
        >>> gears.explore().wait()  # doctest: +SKIP
        """
        while not self._served.done():
            concurrent.futures.wait([self._served], 0.5)

    def stop(self) -> None:
        """Let the server end; `wait` then returns.

        Examples
        --------
        >>> with gears.explore(browser=False) as page:
        ...     page.stop()
        """
        self._server.should_exit = True

    def close(self) -> None:
        """End the server and its process.

        Examples
        --------
        >>> gears.explore(browser=False).close()
        """
        if self._loop.is_closed():
            return
        self.stop()
        concurrent.futures.wait([self._served])
        self._end()

    def _end(self) -> None:
        """End the process for heavy work and the loop."""
        # a process whose start is called off would leave its task without an end
        concurrent.futures.wait([self._begun])
        asyncio.run_coroutine_threadsafe(_ended(self._worker), self._loop).result()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()
        self._socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Explorer: http://{LOOPBACK_ADDRESS}:{self.port}>"


def _try_build(origin: Origin) -> None:
    """Raise what refuses a design or a train."""
    if origin.is_train:
        from gearmesh.explore.trains import try_train

        try_train(origin)
    else:
        try_build(parse_as_stated(nested(origin.keys)))


def _run(loop: asyncio.AbstractEventLoop) -> None:
    """Run a loop until it is stopped; a process or a page that has gone is an error of its connection alone."""
    with closed_pipes_raise():
        loop.run_forever()


async def _opened(worker: Worker, origin: Origin | None, known: Future[bool] | None) -> None:
    """Open a design in the process for heavy work, which begins at once with what the first page will ask.

    `known` gets True when the gears are built, False where the process gives none.
    """
    worker.open(origin)
    if origin is None or known is None:
        return

    def hear(content: bytes) -> None:
        kind = json.loads(content)["type"]
        if kind != "progress" and not known.done():
            known.set_result(kind == "design")
            worker.release()

    worker.held = True
    first = {"do": "show", **origin.state, "last": None, "have": [], "rows": None}
    worker.ask(first, Listener(NO_PAGE, None, hear))


async def _ended(worker: Worker) -> None:
    """End the process for heavy work, and every other task of the loop."""
    await worker.close()
    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)


def explore(design: Design, port: int, *, browser: bool) -> Explorer:
    """Return the running page of a design."""
    return Explorer(origin_of(design), port, browser=browser)


def origin_of(design: Design) -> Origin:
    """Return the origin of a design without a file: the keys that it sets."""
    keys: Mapping[str, Any] = {**design.stated(), "kind": design.kind}
    return Origin.of_text(OPENED_NAME, with_version(keys), keys, Path())


def origin_of_file(path: Path, overrides: Sequence[str] = ()) -> Origin:
    """Return the origin of a design file with overridden keys. Raises DesignError for a file that cannot be read."""
    data = override(read(path), overrides)
    text = toml(data) if path.suffix.lower() == JSON_SUFFIX else rewritten(text_of(path), dict(leaves(data)))
    return Origin.of_text(OPENED_NAME, text, data, path.parent)


def origin_of_kind(kind: str, overrides: Sequence[str] = ()) -> Origin:
    """Return the origin of a new design of a kind with overridden keys. Raises DesignError for an unknown kind."""
    new = Origin.find(KIND_PREFIX + kind)
    if not overrides:
        return new
    data = override(nested(new.keys), overrides)
    return Origin.of_text(OPENED_NAME, rewritten(new.text, dict(leaves(data))), data, Path())


def refuse_port(port: int) -> None:
    """Raise ArgumentError for a port that cannot be chosen."""
    if isinstance(port, bool) or not isinstance(port, int) or not (port == 0 or MIN_PORT <= port <= MAX_PORT):
        raise ArgumentError(
            "port", port, must_be=f"a whole number from {MIN_PORT} to {MAX_PORT}, or 0 for any free port"
        )


def require_server() -> None:
    """Raise OutputError where the server library is not installed."""
    for name in ("starlette", "uvicorn", "websockets"):
        if importlib.util.find_spec(name) is None:
            raise OutputError("explore", reason=f"needs {name}", remedy=f'pip install "gearmesh[{EXTRA_NAME}]"')


def _bound(port: int) -> socket.socket:
    """Return a socket bound to a port of this machine alone. Raises ArgumentError for a port in use."""
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if hasattr(socket, "SO_EXCLUSIVEADDRUSE"):  # of Windows, where another program could listen, too
        made.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
    else:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((LOOPBACK_ADDRESS, port))
    except OSError as failure:
        made.close()
        reason = failure.strerror or str(failure)
        raise ArgumentError(
            "port", port, reason=reason.lower(), remedy="choose another, or 0 for any free port"
        ) from None
    return made


def _wait_for(server: uvicorn.Server, served: concurrent.futures.Future[None]) -> None:
    """Wait until a server has started, as long as that may take on a busy machine. Raises OutputError if it ends before."""
    while not server.started:
        if served.done():
            raise OutputError("explore", reason="the server did not start")
        time.sleep(0.005)
