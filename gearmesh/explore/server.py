"""Answers to the browser of the user, and to nobody else.

- Loopback only. `Host`, `Origin` and `Sec-Fetch-Site` must be those of the page itself. Other sites in the same browser get
  nothing, not even through a name that resolves to this machine.
- The address has a token, which is good once; it is changed for a secret that stays in the browser.
- Pages are read from the package, never from a path in a request; messages are small and have no paths either.
"""

from __future__ import annotations

import asyncio
import hmac
import json
import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from gearmesh.explore.state import Origin
from gearmesh.explore.workers import Listener, Worker
from gearmesh.view.report.page_file import page_file

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.websockets import WebSocket

#: limit of a message of a page, bytes
MAX_MESSAGE_BYTES = 64 * 1024
#: size above which the connection of a message is closed unread, bytes
MAX_FRAME_BYTES = 1024 * 1024
#: limit of the pages that are open at once; at the limit, one that never showed its token or secret makes room
MAX_PAGES = 16
#: limit of the messages of a page that are waiting to be sent; a page that reads none of them is closed
MAX_WAITING_MESSAGES = 1000
#: names of this machine
LOOPBACK_NAMES = ("127.0.0.1", "localhost")
#: code of a closed connection that is not allowed
CLOSED_REFUSED = 4403
#: code of a closed connection beyond the limit of connections
CLOSED_FULL = 4429
#: files of the page by address: name, media type
OWN_FILES = {
    "/": ("explore.html", "text/html"),
    "/explore.css": ("explore.css", "text/css"),
    "/explore.js": ("explore.js", "text/javascript"),
    "/curves.js": ("curves.js", "text/javascript"),
}
#: scripts and styles of the report page by address: name, media type
REPORT_FILES = {
    "/page.css": ("page.css", "text/css"),
    "/scene.js": ("scene.js", "text/javascript"),
    "/three.min.js": ("three.min.js", "text/javascript"),
}
#: part of addresses of pictures of kinds
PICTURES_PATH = "/kinds/"

Scope = MutableMapping[str, Any]
Application = Callable[[Scope, Callable[[], Awaitable[Any]], Callable[[Any], Awaitable[None]]], Awaitable[None]]


class Gate:
    """Right to come in: the token of the address, good once, and the secret of the pages of this run."""

    def __init__(self) -> None:
        self.token, self._secret = secrets.token_urlsafe(32), secrets.token_urlsafe(32)
        self.used = False

    def knows(self, token: str) -> bool:
        """True for the token, used or not."""
        return hmac.compare_digest(token.encode(), self.token.encode())

    def enter(self, message: Any) -> str | None:
        """Return the secret for a first message with the unused token or the secret itself; None for any other."""
        if not isinstance(message, dict) or message.get("do") != "enter":
            return None
        token, secret = message.get("token"), message.get("secret")
        if isinstance(secret, str) and hmac.compare_digest(secret.encode(), self._secret.encode()):
            return self._secret
        if isinstance(token, str) and not self.used and self.knows(token):
            self.used = True
            return self._secret
        return None


class Guard:
    """Refuses requests that do not come from the page itself, and adds the headers that bind the page."""

    def __init__(self, app: Application, port: int) -> None:
        self._app = app
        self._hosts = {f"{name}:{port}" for name in LOOPBACK_NAMES}
        sockets = " ".join(f"ws://{host}" for host in sorted(self._hosts))
        policy = (
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
            f"connect-src 'self' {sockets}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        )
        self._headers = [
            (b"content-security-policy", policy.encode()),
            (b"x-content-type-options", b"nosniff"),
            (b"referrer-policy", b"no-referrer"),
            (b"cross-origin-opener-policy", b"same-origin"),
            (b"cross-origin-resource-policy", b"same-origin"),
            (b"cache-control", b"no-store"),
        ]

    async def __call__(self, scope: Scope, receive: Any, send: Any) -> None:
        """Pass a request on, or refuse it."""
        told = self._refused(scope)
        if told and scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": CLOSED_REFUSED, "reason": told})
            return

        async def send_bound(message: Any) -> None:
            if message["type"] == "http.response.start":
                message = {**message, "headers": [*message.get("headers", []), *self._headers]}
            await send(message)

        if told:
            head = [(b"content-type", b"text/plain; charset=utf-8")]
            await send_bound({"type": "http.response.start", "status": 403, "headers": head})
            await send_bound({"type": "http.response.body", "body": f"refused: {told}\n".encode()})
            return
        await self._app(scope, receive, send_bound)

    def _refused(self, scope: Scope) -> str:
        """Return why a request is refused, "" if it is not."""
        headers: dict[str, list[str]] = {}
        for name, value in scope["headers"]:
            headers.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
        host, origin = headers.get("host", []), headers.get("origin", [])
        if len(host) != 1 or host[0] not in self._hosts:
            return "Host is not this machine"
        if origin and (len(origin) != 1 or origin[0] != f"http://{host[0]}"):
            return "Origin is another site"
        if scope["type"] == "websocket" and not origin:
            return "Origin is missing"
        if scope["type"] == "http" and headers.get("sec-fetch-site", ["none"])[0] not in ("none", "same-origin"):
            return "the request comes from another site"
        return ""


class Pages:
    """The pages that are open, and what they ask."""

    def __init__(self, opened: Origin | None, gate: Gate, worker: Worker) -> None:
        self.gate = gate
        self.opened = opened
        self.worker = worker
        worker.report = self._about_worker
        self._queues: dict[int, asyncio.Queue[bytes | None]] = {}
        # pages that have shown neither token nor secret yet, the oldest first: no clock says how long they may take
        self._outside: list[int] = []
        self._lost = False
        self._numbers = 0

    @property
    def opened_state(self) -> dict[str, Any] | None:
        """State of the opened design as a page has it; None without one."""
        return None if self.opened is None else self.opened.state

    def _about_worker(self, works: bool, line: str) -> None:
        """Tell all pages that the process ended, or that its successor works."""
        if works != self._lost:
            return
        self._lost = not works
        for number in self._queues:
            self._put(number, _text("worker", works=works, line=line))

    def _put(self, number: int, content: bytes) -> None:
        queue = self._queues.get(number)
        if queue is None:
            return
        if queue.qsize() >= MAX_WAITING_MESSAGES:
            self._queues.pop(number)
            queue.put_nowait(None)
        else:
            queue.put_nowait(content)

    async def serve(self, socket: WebSocket) -> None:
        """Serve one page until it goes."""
        from starlette.websockets import WebSocketDisconnect

        await socket.accept()
        if len(self._queues) >= MAX_PAGES:
            self._make_room()
        if len(self._queues) >= MAX_PAGES:
            await socket.close(CLOSED_FULL, f"more than {MAX_PAGES} pages are open")
            return
        self._numbers += 1
        number, queue = self._numbers, asyncio.Queue[bytes | None]()
        self._queues[number] = queue
        self._outside.append(number)
        sending = asyncio.get_running_loop().create_task(_send_all(socket, queue))
        try:
            if await self._enter(socket, number):
                while True:
                    self._take(number, await _received(socket))
        except (WebSocketDisconnect, RuntimeError):
            pass
        finally:
            self._queues.pop(number, None)
            if number in self._outside:
                self._outside.remove(number)
            self.worker.drop(number)
            queue.put_nowait(None)
            await asyncio.gather(sending, return_exceptions=True)

    def _make_room(self) -> None:
        """Close the connection that has shown neither token nor secret for the longest time, if there is one."""
        if self._outside:
            queue = self._queues.pop(self._outside.pop(0), None)
            if queue is not None:
                queue.put_nowait(b"")

    async def _enter(self, socket: WebSocket, number: int) -> bool:
        """Return True once the page has shown its token or secret; all others are told and closed."""
        try:
            first = _parsed(await _received(socket))
        except ValueError:
            first = None
        # one that had to make room comes too late
        secret = self.gate.enter(first) if number in self._outside else None
        if secret is None:
            self._put(
                number, _text("wrong", line="the token is wrong or was used before; start gearmesh explore again")
            )
            self._put(number, b"")
            return False
        self._outside.remove(number)
        self._put(number, _text("entered", secret=secret, opened=self.opened_state))
        return True

    def _take(self, number: int, text: str | bytes) -> None:
        """Take a message of a page: each is answered."""
        try:
            request = _parsed(text)
        except ValueError as wrong:
            self._put(number, _text("wrong", line=str(wrong)))
            return
        if request.get("do") not in ("show", "range", "file", "open", "start"):
            line = "a message must ask to show, range, file, open or start"
            self._put(number, _text("wrong", line=line, id=_identity(request)))
            return
        question = {key: request[key] for key in REQUEST_FIELDS if key in request}
        self.worker.ask(question, Listener(number, _identity(request), lambda content: self._put(number, content)))


#: fields of a question of a page; others are dropped
REQUEST_FIELDS = ("do", "from", "keys", "last", "good", "have", "rows", "key", "suffix", "member")


def _identity(request: dict[str, Any]) -> int | None:
    """Return the number of a message, None if it has none."""
    number = request.get("id")
    return number if isinstance(number, int) and abs(number) < 2**53 else None


def _parsed(text: str | bytes) -> dict[str, Any]:
    """Return the JSON table of a message. Raises ValueError in one line."""
    if isinstance(text, bytes):
        raise ValueError("a message must be a text")
    if len(text) > MAX_MESSAGE_BYTES or len(text.encode("utf-8", "surrogatepass")) > MAX_MESSAGE_BYTES:
        raise ValueError(f"a message has at most {MAX_MESSAGE_BYTES} bytes")

    def refuse(name: str) -> Any:
        raise ValueError(f"{name} is no JSON number")

    try:
        message = json.loads(text, parse_constant=refuse)
        # lone surrogates cannot be passed on
        text.encode()
    except (ValueError, RecursionError) as wrong:
        raise ValueError(f"a message must be JSON: {str(wrong)[:100]}") from None
    if not isinstance(message, dict):
        raise ValueError("a message must be a JSON object")
    return message


async def _received(socket: WebSocket) -> str | bytes:
    """Return the next message. Raises WebSocketDisconnect."""
    from starlette.websockets import WebSocketDisconnect

    message = await socket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message.get("code", 1000))
    text = message.get("text")
    content: bytes = message.get("bytes") or b""
    return content if text is None else str(text)


async def _send_all(socket: WebSocket, queue: asyncio.Queue[bytes | None]) -> None:
    """Send messages until None; an empty one closes the connection after what was sent before."""
    while (content := await queue.get()) is not None:
        if not content:
            await socket.close(CLOSED_REFUSED)
            return
        await socket.send_text(content.decode())


def _text(kind: str, **fields: Any) -> bytes:
    return json.dumps({"type": kind, **fields}, allow_nan=False).encode()


def application(opened: Origin | None, gate: Gate, port: int, worker: Worker) -> tuple[Application, Pages]:
    """Return the application of the page on a port, and its pages, whose questions a `worker` answers."""
    from starlette.applications import Starlette
    from starlette.responses import PlainTextResponse, Response
    from starlette.routing import Route, WebSocketRoute

    pages = Pages(opened, gate, worker)
    page = files(__package__) / "page"

    async def file(request: Request) -> Response:
        path = request.url.path
        token = request.query_params.get("token")
        if token is not None and not gate.knows(token):
            return PlainTextResponse("refused: the token in the address is wrong\n", 403)
        if path in REPORT_FILES:
            name, media = REPORT_FILES[path]
            content = page_file(name)
        else:
            name, media = OWN_FILES[path]
            content = (page / name).read_text(encoding="utf-8")
            if path == "/":
                content = content.replace("{{VIEWER}}", page_file("viewer.html"))
        return Response(content, media_type=media)

    pictures = {each.name: each for each in (page / "kinds").iterdir() if each.name.endswith(".jpg")}

    async def picture(request: Request) -> Response:
        found = pictures.get(request.path_params["name"])
        return (
            PlainTextResponse("no such picture\n", 404)
            if found is None
            else Response(found.read_bytes(), media_type="image/jpeg")
        )

    routes = [
        *(Route(path, file, methods=["GET"]) for path in (*OWN_FILES, *REPORT_FILES)),
        Route(PICTURES_PATH + "{name}", picture, methods=["GET"]),
        WebSocketRoute("/socket", pages.serve),
    ]
    return Guard(Starlette(routes=routes), port), pages
