"""The panel as a server: one page, its files and one socket, for as long as somebody wants it."""

import asyncio
import json
import socket
import tempfile
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from importlib import resources
from pathlib import Path
from typing import Any

from bridge.errors import RunError, UsageError
from bridge.machine.children import guarded
from bridge.machine.priority import stand_back
from bridge.panel.clients import Client, packed
from bridge.panel.desk import Desk
from bridge.panel.doors import LOOPBACK, Doors, Guest, doors_for, is_loopback, is_own
from bridge.panel.own_run import startable
from bridge.panel.station import Place, Station
from bridge.scenario.files import listed, names

COOKIE = "hydrotwin"
LONGEST = 64_000  # bytes of what a page may send
GRACE = 1  # [s] that pages get to notice the end
HEADERS = {
    "Content-Security-Policy": "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}
MISSING = "the panel needs starlette, uvicorn and websockets: pip install 'hydrotwin[panel]'"
NO_TOKEN = "This panel asks for a token: open the address that `hydrotwin panel` has printed, token and all.\n"


def serve(place: Place, host: str, port: int, watch_only: bool, ready: Callable[[list[str]], None]) -> None:
    """Serve until Ctrl-C. ready: told the addresses. Raises UsageError where the panel cannot be served."""
    try:
        import uvicorn
        import websockets  # noqa: F401, without it uvicorn serves pages but no sockets
    except ImportError:
        raise UsageError(MISSING) from None
    listening, doors = _socket(host, port), doors_for(host, watch_only)
    if place.rig_name:  # what we start ourselves would inherit it
        stand_back()
    with tempfile.TemporaryDirectory(prefix="hydrotwin-") as folder, guarded() as environment:
        station = Station(place, Path(folder), environment)
        served = application(station, doors, host)
        settings: dict[str, Any] = {"log_level": "warning", "access_log": False, "server_header": False}
        settings |= {"ws_per_message_deflate": False, "ws_max_size": LONGEST, "timeout_graceful_shutdown": GRACE}
        server = uvicorn.Server(uvicorn.Config(served, lifespan="on", **settings))
        ready(_addresses(host, listening.getsockname()[1], doors))
        with suppress(KeyboardInterrupt):
            asyncio.run(server.serve([listening]))


def _socket(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
        listening.listen()  # who comes before the server is up waits
    except (OSError, OverflowError) as error:
        listening.close()
        raise UsageError(
            f"cannot serve the panel at {host}, port {port}: {error}; choose another one with --port, or --host"
        ) from None
    return listening


def _addresses(host: str, port: int, doors: Doors) -> list[str]:
    shown = f"[{host}]" if ":" in host else socket.gethostname() if host in ("0.0.0.0", "::") else host
    base = f"http://{shown}:{port}/"
    return [f"{base}?token={token}  ({who})" for who, token in doors.tokens.items()] or [base]


def application(station: Station, doors: Doors, host: str) -> Any:
    """The page, its files and its socket, to be served at an address."""
    from starlette.applications import Starlette
    from starlette.middleware import Middleware
    from starlette.middleware.trustedhost import TrustedHostMiddleware
    from starlette.requests import Request
    from starlette.responses import FileResponse, PlainTextResponse, RedirectResponse, Response
    from starlette.routing import Route, WebSocketRoute
    from starlette.websockets import WebSocket, WebSocketDisconnect

    desk, files = Desk(station), _files()

    def guest_of(cookies: Mapping[str, str]) -> Guest | None:
        return doors.guest(cookies.get(COOKIE))

    async def page(request: Request) -> Response:
        name = request.path_params.get("name") or "index.html"
        if (token := request.query_params.get("token")) is not None and doors.guest(token) and doors.tokens:
            answer = RedirectResponse("/", headers=HEADERS)
            answer.set_cookie(COOKIE, token, httponly=True, samesite="strict")
            return answer
        if guest_of(request.cookies) is None:
            return PlainTextResponse(NO_TOKEN, 403, headers=HEADERS)
        if name not in files:
            return PlainTextResponse(f"there is no {name}\n", 404, headers=HEADERS)
        return FileResponse(files[name], headers=HEADERS)

    async def talk(ws: WebSocket) -> None:
        guest = guest_of(ws.cookies)
        if guest is None or not is_own(ws.headers.get("origin"), ws.headers.get("host")):
            await ws.close(1008)
            return
        await ws.accept()
        client = Client(guest)
        client.send(packed("hello", _hello(station, guest)))
        station.greet(client)
        sending = asyncio.create_task(_send(ws, client))
        try:
            while True:
                await _hear(ws, client, desk)
        except WebSocketDisconnect:
            pass
        finally:
            station.clients.remove(client)
            sending.cancel()

    hosts = list(LOOPBACK) if is_loopback(host) else ["*"]
    return Starlette(
        routes=[Route("/", page), Route("/{name}", page), WebSocketRoute("/socket", talk)],
        middleware=[Middleware(TrustedHostMiddleware, allowed_hosts=[*hosts, host])],
        lifespan=_life(station),
    )


def _life(station: Station) -> Any:
    @asynccontextmanager
    async def life(_: Any) -> AsyncIterator[None]:
        working = asyncio.create_task(station.work())
        working.add_done_callback(_tell_failure)
        starting = asyncio.create_task(_first_run(station))
        starting.add_done_callback(_tell_failure)
        yield
        starting.cancel()
        working.cancel()
        await station.close()

    return life


async def _first_run(station: Station) -> None:
    if station.place.rig_name is None:
        try:
            await station.start(station.place.wish)
        except (UsageError, RunError) as error:
            station.note = str(error)
        except Exception as error:
            station.note = f"the run could not be started: {error!r}"
            raise


def _tell_failure(task: "asyncio.Task[None]") -> None:
    if not task.cancelled() and (error := task.exception()):
        asyncio.get_running_loop().call_exception_handler({"message": "the panel has failed", "exception": error})


async def _send(ws: Any, client: Client) -> None:
    while (text := await client.next()) is not None:
        await ws.send_text(text)
    await ws.close(1013)


async def _hear(ws: Any, client: Client, desk: Desk) -> None:
    text = await ws.receive_text()
    try:
        asked = json.loads(text)
    except (ValueError, RecursionError):
        asked = None
    client.send(packed("answer", await desk.answer(client, asked)))


def _hello(station: Station, guest: Guest) -> dict[str, Any]:
    wish = station.place.wish
    titles = {name: listed(name).title for name in names()}
    scenarios = [{"name": name, "title": titles.get(name, "")} for name in startable(wish.scenario)]
    return {"guest": guest, "scenarios": scenarios, "wish": wish.scenario, "endless": wish.endless}


def _files() -> dict[str, Path]:
    """The page and all that it needs."""
    folder = resources.files("bridge.panel") / "page"
    return {Path(str(path)).name: Path(str(path)) for path in folder.iterdir() if path.is_file()}
