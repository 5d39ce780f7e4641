"""The server of the local page: who gets in, and what it answers to messages that no page sends."""

from __future__ import annotations

import asyncio
import http.client
import io
import json
import math
import os
import random
import signal
import socket
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import pytest
from oracles.command_line import refused
from oracles.places import SAMPLES
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from gearmesh import Explorer
from gearmesh.explore.explorer import origin_of_file, origin_of_kind
from gearmesh.explore.frames import frame
from gearmesh.explore.server import MAX_FRAME_BYTES, MAX_MESSAGE_BYTES, MAX_PAGES
from gearmesh.explore.worker import Answers
from gearmesh.explore.workers import HANG_S, NO_PAGE, Asked, Listener, Worker

SPUR = SAMPLES / "spur.toml"
#: time in which every answer must have come, s; the machine may be busy
PATIENCE_S = 120


@pytest.fixture(scope="module")
def running() -> Iterator[Explorer]:
    with Explorer(origin_of_file(SPUR), browser=False) as page:
        yield page


def answer(page: Explorer, path: str, method: str = "GET", **headers: str) -> tuple[int, str, dict[str, str]]:
    """Status, text and headers of an answer; a header named Host replaces that of the client."""
    link = http.client.HTTPConnection("127.0.0.1", page.port, timeout=PATIENCE_S)
    link.putrequest(method, path, skip_host="Host" in headers)
    for name, value in headers.items():
        link.putheader(name.replace("_", "-"), value)
    link.endheaders()
    given = link.getresponse()
    text = given.read().decode("utf-8", "replace")
    link.close()
    return given.status, text, {name.lower(): value for name, value in given.getheaders()}


@contextmanager
def opened(page: Explorer, **headers: Any) -> Iterator[ClientConnection]:
    origin = headers.pop("origin", f"http://127.0.0.1:{page.port}")
    with connect(f"ws://127.0.0.1:{page.port}/socket", origin=origin, max_size=None, **headers) as link:
        yield link


@contextmanager
def entered(page: Explorer) -> Iterator[ClientConnection]:
    """A connection of a page that is in; the first takes the token, the others its secret."""
    with opened(page) as link:
        secret = getattr(page, "known_secret", None)
        token = page.url.partition("token=")[2]
        link.send(json.dumps({"do": "enter", "token": token, "secret": secret}))
        message = json.loads(link.recv(timeout=PATIENCE_S))
        assert message["type"] == "entered", message
        page.known_secret = message["secret"]  # type: ignore[attr-defined]
        yield link


def test_page_is_bound_to_this_machine_and_to_itself(running: Explorer) -> None:
    status, text, headers = answer(running, "/")
    assert (status, headers["content-type"]) == (200, "text/html; charset=utf-8")
    policy = dict(part.strip().split(" ", 1) for part in headers["content-security-policy"].split(";"))
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == "'self'"
    assert policy["frame-ancestors"] == policy["base-uri"] == policy["form-action"] == "'none'"
    # nothing of the page is inline, and nothing comes from elsewhere
    assert "<style" not in text
    assert "onclick" not in text
    assert text.count("<script") == text.count('<script src="/')
    assert headers["referrer-policy"] == "no-referrer"
    assert running._socket.getsockname()[0] == "127.0.0.1"


@pytest.mark.parametrize(
    ("headers", "why"),
    [
        ({"Host": "evil.example"}, "Host"),
        ({"Host": "evil.example:{port}"}, "Host"),
        ({"Host": "127.0.0.1:1"}, "Host"),
        ({"Origin": "http://evil.example"}, "Origin"),
        ({"Origin": "null"}, "Origin"),
        ({"Sec_Fetch_Site": "cross-site"}, "another site"),
    ],
)
def test_other_sites_get_nothing(running: Explorer, headers: dict[str, str], why: str) -> None:
    given = {name: value.format(port=running.port) for name, value in headers.items()}
    for path in ("/", "/explore.js", "/kinds/cylindrical.jpg"):
        status, text, _ = answer(running, path, **given)
        assert status == 403
        assert why in text
        assert len(text.splitlines()) == 1


@pytest.mark.parametrize(
    "path",
    ["/../pyproject.toml", "/kinds/..%2f..%2fserver.py", "/etc/passwd", "//etc/passwd", "/kinds/%00", "/explore.py"],
)
def test_paths_lead_nowhere(running: Explorer, path: str) -> None:
    status, text, _ = answer(running, path)
    assert status == 404
    assert "import" not in text


def test_only_reading(running: Explorer) -> None:
    assert {answer(running, "/", method)[0] for method in ("POST", "PUT", "DELETE")} == {405}


def test_wrong_token(running: Explorer) -> None:
    status, text, _ = answer(running, "/?token=guess")
    assert (status, text) == (403, "refused: the token in the address is wrong\n")
    for first in (
        {"do": "enter", "token": "guess"},
        {"do": "show"},
        "enter",
        {"do": "enter", "token": 3, "secret": []},
    ):
        with opened(running) as link:
            link.send(json.dumps(first))
            assert json.loads(link.recv(timeout=PATIENCE_S))["type"] == "wrong"
            with pytest.raises(ConnectionClosed):
                link.recv(timeout=PATIENCE_S)


@pytest.mark.parametrize("origin", [None, "http://evil.example", "null"])
def test_sockets_of_other_sites_are_refused(running: Explorer, origin: str | None) -> None:
    with pytest.raises(InvalidStatus), opened(running, origin=origin):
        pass


def test_token_is_good_once(running: Explorer) -> None:
    with entered(running) as link:
        assert link is not None
    with opened(running) as link:
        link.send(json.dumps({"do": "enter", "token": running.url.partition("token=")[2]}))
        message = json.loads(link.recv(timeout=PATIENCE_S))
        assert message["type"] == "wrong"
        assert "used before" in message["line"]


def test_silent_connections_make_room_for_a_page(running: Explorer) -> None:
    """No clock closes a connection that shows no token; the oldest goes when the room is needed."""
    with ExitStack() as links:
        silent = [links.enter_context(opened(running)) for _ in range(MAX_PAGES)]
        with entered(running) as page:
            page.send(json.dumps({"do": "start", "id": 1}))
            assert json.loads(page.recv(timeout=PATIENCE_S))["type"] in ("start", "progress")
            with pytest.raises(ConnectionClosed):
                silent[0].recv(timeout=PATIENCE_S)
            # the others may still come in
            silent[-1].send(json.dumps({"do": "enter", "secret": running.known_secret}))  # type: ignore[attr-defined]
            assert json.loads(silent[-1].recv(timeout=PATIENCE_S))["type"] == "entered"


def malformed(count: int) -> Iterator[str | bytes]:
    """Messages that no page sends: no JSON, no object, wrong fields, wrong values, deep, long, binary."""
    chance = random.Random(57)
    good = {"do": "show", "from": "opened", "keys": {"kind": "cylindrical"}}
    junk: list[Any] = [
        None,
        True,
        -1,
        1e308,
        "",
        "x" * 600,
        [],
        [[[[]]]],
        {},
        {"a": {"b": 1}},
        "../../etc/passwd",
        "\u0000",
        "sample:../x",
        10**400,
    ]
    show = {"do": "show", "from": "opened"}
    objects: list[Any] = [
        {**show, "keys": {"kind": "spur", "pinion": {"teeth": 3}}},
        {**show, "keys": {"kind": "cylindrical", "pinion": 3, "pinion.teeth": 20}},
        {**show, "keys": {"kind": "cylindrical", "measured.pinion.right": "/etc/passwd"}},
        {**good, "do": "file", "suffix": ".exe", "member": "pinion"},
        {**good, "do": "file", "suffix": ".stl", "member": "../../x"},
        {**good, "do": "range", "key": "name"},
        {"do": "open", "from": "sample:../../pyproject"},
        {"do": "open", "from": "kind:nothing"},
    ]
    fixed: list[str | bytes] = [
        *(
            "",
            "{",
            "null",
            "[]",
            "3",
            '"show"',
            "NaN",
            '{"do": NaN}',
            '{"do": Infinity}',
            "[" * 60_000,
            '{"a":' * 10_000,
        ),
        *(
            b"",
            b"\xff\xfe",
            b'{"do": "show"}',
            "\ufffd",
            '{"do": "\\ud800"}',
            '{"do": "show", "from": "\\ud800", "keys": {}}',
        ),
        '{"do": "show", "id": "' + "x" * MAX_MESSAGE_BYTES + '"}',
        *map(json.dumps, objects),
    ]
    yield from fixed
    for _ in range(count - len(fixed)):
        message: dict[str, Any] = dict(
            good, do=chance.choice(["show", "range", "file", "open", "start", "enter", "stop"])
        )
        for _ in range(chance.randint(1, 3)):
            message[chance.choice(["do", "from", "keys", "key", "suffix", "member", "id"])] = chance.choice(junk)
        keys = message["keys"]
        if isinstance(keys, dict) and chance.random() < 0.5:
            name = chance.choice(["Module", "pinion..teeth", "", "a" * 99, "pinion.teeth", "module"])
            message["keys"] = {**keys, name: chance.choice(junk)}
        yield json.dumps(message)


def test_200_malformed_messages_are_answered_and_end_nothing(running: Explorer) -> None:
    with entered(running) as link:
        for text in malformed(200):
            link.send(text)
            types = []
            while not types or (types[-1] not in ("wrong", "end")):
                message = json.loads(link.recv(timeout=PATIENCE_S))
                if message.get("id") is None or message["type"] in ("wrong", "end", "refused"):
                    types.append(message["type"])
                    line = message.get("line", "")
                    assert len(line.splitlines()) <= 1
                    assert "fault of the program" not in line, (text[:200], line)
                    assert "root:" not in line
        # a page still gets its gears
        link.send(json.dumps({"do": "show", "id": 7, **running.pages.opened_state}))
        found = [json.loads(link.recv(timeout=PATIENCE_S)) for _ in range(1)]
        while found[-1]["type"] != "end":
            found.append(json.loads(link.recv(timeout=PATIENCE_S)))
        assert {"design", "figures", "scene"} <= {message["type"] for message in found}
        # a message that is far too long closes its own connection alone
        link.send("x" * (MAX_FRAME_BYTES + 1))
        with pytest.raises(ConnectionClosed):
            [link.recv(timeout=PATIENCE_S) for _ in range(9)]
    assert answer(running, "/")[0] == 200


@pytest.mark.quick
def test_a_page_joins_work_that_is_done_already() -> None:
    heard: dict[int, list[dict[str, Any]]] = {0: [], 1: [], 2: []}

    def page(number: int, identity: int | None) -> Listener:
        return Listener(number, identity, lambda content: heard[number].append(json.loads(content)))

    first: dict[str, Any] = {"do": "show", "keys": {"module": 2}}
    worker = Worker()
    worker.ask(first, page(NO_PAGE, None))
    worker.running = running = worker.waiting.pop()
    running.hear(b'{"type":"design"}')
    # the same question: what has come comes at once, what follows comes to both
    worker.ask(dict(first), page(1, 5))
    worker.ask(dict(first), page(2, 7))
    running.hear(b"{}")
    assert worker.waiting == []
    assert heard[1] == [{"type": "design", "id": 5}, {"id": 5}]
    assert heard[2] == [{"type": "design", "id": 7}, {"id": 7}]
    # nobody waits for what no page asked, and a newer question of a page ends its older one alone
    assert [each.page for each in running.listeners] == [1, 2]
    worker.ask({**first, "keys": {"module": 3}}, page(1, 6))
    assert [each.page for each in running.listeners] == [2]
    # work that nobody wants is not joined
    worker.drop(2)
    worker.ask(dict(first), page(2, 8))
    assert [each.listeners[0].identity for each in worker.waiting] == [6, 8]


@pytest.mark.quick
@pytest.mark.parametrize("asks", [True, False])
def test_a_page_that_opens_while_the_gears_are_built_takes_no_answer_from_the_program(*, asks: bool) -> None:
    worker, first = Worker(held=True), {"do": "show", "keys": {"module": 2}}
    worker.ask(first, Listener(NO_PAGE, None, lambda content: None))
    worker.running = running = worker.waiting.pop()
    if asks:
        # the browser is faster than the gears
        worker.ask(dict(first), Listener(1, 5, lambda content: None))
        worker.ask({**first, "keys": {"module": 3}}, Listener(1, 6, lambda content: None))
    assert [each.page for each in running.listeners] == [NO_PAGE]
    worker.release()
    # from now on the work is that of pages alone; without any it goes on for the one to come
    assert [each.page for each in running.listeners] == ([] if asks else [NO_PAGE])
    worker.ask(dict(first), Listener(2, 7, lambda content: None))
    assert [each.page for each in running.listeners] == ([] if asks else [2])


@pytest.mark.quick
def test_a_file_does_not_wait_for_the_range_of_a_key() -> None:
    worker = Worker()
    listeners = [Listener(page, number, lambda content: None) for page, number in ((1, 5), (2, 6), (1, 7))]
    worker.ask({"do": "range", "key": "module"}, listeners[0])
    worker.running = running = worker.waiting.pop()
    worker.ask({"do": "range", "key": "backlash"}, listeners[1])
    worker.ask({"do": "file", "suffix": ".toml"}, listeners[2])
    assert running.listeners == []
    # that of another page waits
    assert [each.what for each in worker.waiting] == ["range", "file"]


class Still:
    """Process that answers only what is fed to it."""

    returncode: int | None = None
    stdin = None

    def __init__(self) -> None:
        self.stdout = asyncio.StreamReader()

    def kill(self) -> None:
        self.returncode = 0

    async def wait(self) -> None:
        pass


@pytest.mark.quick
def test_work_that_goes_on_says_so_and_no_page_hears_it(monkeypatch: pytest.MonkeyPatch) -> None:
    output = io.BytesIO()
    answers = Answers(output, 1)
    monkeypatch.setattr("gearmesh.explore.worker.SIGN_INTERVAL_S", math.inf)
    answers.sign()
    assert not output.getvalue()
    # longer than no time at all
    monkeypatch.setattr("gearmesh.explore.worker.SIGN_INTERVAL_S", -1.0)
    answers.sign()
    answers.send({"type": "end", "status": "done"})

    async def heard() -> list[bytes]:
        worker, found = Worker(), list[bytes]()
        worker.process = Still()  # type: ignore[assignment]
        worker.process.stdout.feed_data(output.getvalue())  # type: ignore[union-attr]
        await worker._work(Asked({"do": "show"}, [Listener(1, None, found.append)]))
        return found

    (end,) = asyncio.run(heard())
    assert json.loads(end) == {"type": "end", "status": "done", "id": None}


@pytest.mark.quick
@pytest.mark.parametrize("turns", range(7))
def test_a_page_closes_at_every_step_of_an_answer(turns: int) -> None:
    """The last answer may come in any turn of the loop before the page is closed."""

    async def closes() -> bool:
        worker, process = Worker(), Still()
        worker.process = process  # type: ignore[assignment]
        worker.open(None)
        worker.ask({"do": "show"}, Listener(1, 1, lambda content: None))
        for _ in range(5):  # until the worker waits for the answer
            await asyncio.sleep(0)
        process.stdout.feed_data(frame(b'{"job":1,"type":"end"}\n{}'))
        for _ in range(turns):
            await asyncio.sleep(0)
        closing = asyncio.create_task(worker.close())
        for _ in range(50):
            await asyncio.sleep(0)
        return closing.done()

    assert asyncio.run(closes())


@pytest.mark.sweep
@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_a_process_that_hangs_is_replaced_and_the_question_answered(
    running: Explorer, monkeypatch: pytest.MonkeyPatch
) -> None:
    worker, lose = running.pages.worker, Worker._lose
    process = worker.process
    assert process is not None

    async def lose_and_wait(self: Worker, asked: Asked, *, hung: bool) -> None:
        assert hung
        # the new process may take as long as it needs
        monkeypatch.setattr(worker, "hang_s", HANG_S)
        await lose(self, asked, hung=hung)

    state = running.pages.opened_state
    assert state is not None
    with entered(running) as link:
        link.send(json.dumps({"do": "start", "id": 2}))
        while json.loads(link.recv(timeout=PATIENCE_S))["type"] != "end":
            pass
        monkeypatch.setattr(Worker, "_lose", lose_and_wait)
        monkeypatch.setattr(worker, "hang_s", 0.1)
        os.kill(process.pid, signal.SIGSTOP)
        link.send(json.dumps({"do": "show", "id": 3, "from": "opened", "keys": {**state["keys"], "backlash": 0.07}}))
        found = [json.loads(link.recv(timeout=PATIENCE_S))]
        while found[-1]["type"] != "end":
            found.append(json.loads(link.recv(timeout=PATIENCE_S)))
    told = [each for each in found if each["type"] == "worker"]
    assert [each["works"] for each in told] == [False, True]
    assert "gave no answer" in told[0]["line"]
    assert "a new one takes over" in told[0]["line"]
    assert next(each for each in found if each["type"] == "design")["values"]["backlash"] == 0.07
    assert process.returncode is not None


@pytest.mark.quick
@pytest.mark.parametrize("hung", [False, True])
def test_only_a_process_that_hangs_is_killed(monkeypatch: pytest.MonkeyPatch, *, hung: bool) -> None:
    """To kill one that has ended takes its status away from asyncio, which says so on standard error."""
    told: list[str] = []

    async def start(self: Worker) -> None:
        self.process = Still()  # type: ignore[assignment]
        self.process.stdout.feed_data(frame(b'{"job":2,"type":"end"}\n{"type":"end"}'))

    async def lost() -> int | None:
        answered = asyncio.Event()
        worker, process = Worker(lambda works, line: told.append(line), hang_s=0.0 if hung else HANG_S), Still()
        worker.process = process  # type: ignore[assignment]
        if not hung:
            process.stdout.feed_eof()
        worker.open(None)
        worker.ask({"do": "show"}, Listener(1, 1, lambda content: answered.set()))
        if hung:
            while not told:
                await asyncio.sleep(0)
            worker.hang_s = HANG_S
        await answered.wait()
        await worker.close()
        return process.returncode

    monkeypatch.setattr(Worker, "start", start)
    killed = asyncio.run(lost()) is not None
    assert killed is hung
    assert ("gave no answer" if hung else "ended") in told[0]


def test_port_in_use_is_one_line() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        line = refused("explore", SPUR, "--no-browser", "--port", str(port))
        assert line.startswith(f"--port = {port}: address already in use")
    assert refused("explore", "--no-browser", "--port", "80").startswith(
        "--port = 80: must be a whole number from 1024"
    )
    assert refused("explore", "cylindrcal", "--no-browser").startswith('kind = "cylindrcal"')
    assert refused("explore", SPUR, "--no-browser", "--set", "pinion.teeth=x").startswith(
        'pinion.teeth = "x": must be a whole'
    )
    # gears that cannot be built: of a file, and of a kind with other values
    assert refused("explore", SPUR, "--no-browser", "--set", "pressure_angle=44").startswith("pinion.dedendum = 1.25: ")
    assert refused("explore", "hypoid", "--no-browser", "--set", "pinion.teth=9").startswith("pinion.teth: unknown key")
    assert refused("explore", "--no-browser", "--set", "module=2").startswith("--set = module=2: needs a design")


@pytest.mark.sweep
def test_values_given_with_a_kind_are_those_of_its_page() -> None:
    origin = origin_of_kind("cylindrical", ["pinion.teeth=23"])
    assert origin.shown["pinion.teeth"] == 23
    assert tomllib.loads(origin.text)["pinion"]["teeth"] == 23


@pytest.mark.sweep
@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_interrupt_of_a_terminal_ends_all_without_a_word() -> None:
    """Ctrl-C goes to all processes of the terminal, also to the one for heavy work."""
    program = (sys.executable, "-m", "gearmesh", "explore", str(SPUR), "--no-browser")
    with subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith(b"http://127.0.0.1:")
        os.killpg(process.pid, signal.SIGINT)
        assert process.communicate(timeout=PATIENCE_S)[1] == b""
        assert process.returncode == 0
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)
