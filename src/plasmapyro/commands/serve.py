"""`plasmapyro serve`: a page on this machine, on which the folder of a test is dropped."""

import contextlib
import hmac
import io as text_io
import json
import secrets
import shutil
import sys
import tempfile
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

from plasmapyro import cli
from plasmapyro.page.shell import rendered
from plasmapyro.readers.guess import describe
from plasmapyro.readers.text import Refusal

LARGEST_FILE, LARGEST_FOLDER, MOST_FILES = 100_000_000, 500_000_000, 5000  # [byte], [byte], files
LONGEST_NAME, DEEPEST = 200, 4
PATIENCE = 30.0  # [s] for a browser that stops in the middle
FORBIDDEN = set('<>:"|?*\\')  # in names, on one system or another
RESERVED = {"con", "prn", "aux", "nul", *(f"{name}{i}" for name in ("com", "lpt") for i in range(10))}
KINDS = {
    ".html": "text/html; charset=utf-8",
    ".json": "application/json",
    ".yaml": "text/plain; charset=utf-8",
}
RESULTS = {
    "correct": ("temperature.html", ["temperature.nc", "temperature.html"]),
    "diagnose": ("diagnosis/index.html", ["diagnosis/diagnosis.json", "diagnosis/temperature.nc"]),
}


def run(options):
    """Run `plasmapyro serve` until it is stopped."""
    if not Path(options.instrument).is_dir():
        raise ValueError(f"{options.instrument}: no such folder; name the one that holds calibration.nc")
    with server(options.instrument, options.radiance, options.port) as (served, address):
        sys.stdout.write(f"open {address}\nCtrl-C ends it\n")
        sys.stdout.flush()
        with contextlib.suppress(KeyboardInterrupt):
            served.serve_forever()


@contextlib.contextmanager
def server(instrument, radiance=None, port=0):
    """A server with a folder of its own, removed at the end; and its address with the token."""
    place = Path(tempfile.mkdtemp(prefix="plasmapyro-"))
    try:
        with HTTPServer(("127.0.0.1", port), Page) as served:
            served.token, served.place = secrets.token_urlsafe(32), place
            served.instrument, served.radiance = str(Path(instrument).resolve()), radiance
            yield served, f"http://127.0.0.1:{served.server_port}/{served.token}/"
    finally:
        shutil.rmtree(place, ignore_errors=True)


def safe_name(name):
    """The parts of a file name that stays in its folder on every system, or None."""
    parts = name.split("/")
    good = 0 < len(name) <= LONGEST_NAME and len(parts) <= DEEPEST and name.isprintable()
    good &= not FORBIDDEN & set(name) and all(part.strip(" .") == part != "" for part in parts)
    return parts if good and not any(part.split(".")[0].lower() in RESERVED for part in parts) else None


class Page(BaseHTTPRequestHandler):
    """Answers to the page; every address begins with the token."""

    timeout = PATIENCE
    server_version, sys_version = "plasmapyro", ""

    def log_message(self, *_):  # addresses hold the token
        pass

    def do_GET(self):
        self._answer({"": self._page, "result": self._result})

    def do_PUT(self):
        self._answer({"file": self._file})

    def do_POST(self):
        self._answer(
            dict.fromkeys(("correct", "diagnose"), self._work) | {"reset": self._reset, "check": self._check}
        )

    def _answer(self, known):
        own = {f"{name}:{self.server.server_port}" for name in ("127.0.0.1", "localhost")}
        origin = self.headers.get("Origin")
        _, token, path = (urlsplit(self.path).path.split("/", 2) + ["", ""])[:3]
        self.what, _, self.rest = path.partition("/")
        right = hmac.compare_digest(token.encode("utf-8", "replace"), self.server.token.encode())
        # A page from elsewhere that guesses the port gets nothing, by another name of this machine either.
        if (
            self.headers.get("Host") not in own
            or (origin and origin.removeprefix("http://") not in own)
            or not right
        ):
            return self._say(403, {"said": "open the address that the program has shown"})
        if self.what not in known:
            return self._say(404, {"said": "no such page"})
        try:
            known[self.what]()
        except Refusal as refusal:
            self._say(200, {"said": "\n".join(refusal.messages)})
        except (ValueError, OSError) as fault:
            self._say(400, {"said": str(fault)})

    def _send(self, status, content, kind, policy):
        self.send_response(status)
        headers = {
            "Content-Type": kind,
            "Content-Length": str(len(content)),
            "Content-Security-Policy": policy,
        }
        headers |= {
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cache-Control": "no-store",
        }
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def _say(self, status, values):
        hidden = json.dumps(values).replace(json.dumps(str(self.server.place))[1:-1], "")
        self._send(status, hidden.encode(), "application/json", "default-src 'none'")

    def _page(self):
        nonce = secrets.token_urlsafe(16)
        text = rendered("drop.html", nonce=nonce, diagnosis=bool(self.server.radiance))
        policy = (
            f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'unsafe-inline'; connect-src 'self';"
            " frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        )
        self._send(200, text.encode(), KINDS[".html"], policy)

    def _result(self):
        known = {name for page, files in RESULTS.values() for name in (page, *files)}
        path = self.server.place / "out" / self.rest
        if self.rest not in known or not path.is_file():
            return self._say(404, {"said": "no such result"})
        policy = "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:"
        self._send(200, path.read_bytes(), KINDS.get(path.suffix, "application/octet-stream"), policy)

    @property
    def _folder(self):
        return self.server.place / "test"

    def _reset(self):
        for name in ("test", "out"):
            shutil.rmtree(self.server.place / name, ignore_errors=True)
        self._say(200, {"said": ""})

    def _file(self):
        name = parse_qs(urlsplit(self.path).query).get("name", [""])[0]
        parts, length = safe_name(name), self.headers.get("Content-Length", "")
        if not length.isascii() or not length.isdigit() or int(length) > LARGEST_FILE:
            self.close_connection = True
            return self._say(413, {"said": f"a file may have up to {LARGEST_FILE / 1e6:g} MB"})
        content = self.rfile.read(int(length))
        if parts is None:
            raise ValueError(f"{name[:LONGEST_NAME]!r}: this name is not taken; rename the file")
        held = [path.stat().st_size for path in self._folder.rglob("*") if path.is_file()]
        if len(held) >= MOST_FILES or sum(held) + len(content) > LARGEST_FOLDER:
            raise ValueError(f"a folder may have {MOST_FILES} files and {LARGEST_FOLDER / 1e6:g} MB")
        path = self._folder.joinpath(*parts)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        self._say(200, {})

    def _check(self):
        path = self._folder / "test.yaml"
        self._folder.mkdir(parents=True, exist_ok=True)
        if not path.exists() and not (self._folder / "test.nc").exists():
            path.write_text(describe(self._folder).text, encoding="utf-8")
        _, said = self._command("check", str(self._folder))
        text = path.read_text(encoding="utf-8", errors="replace") if path.exists() else ""
        self._say(200, {"said": said, "yaml": text})

    def _work(self):
        out, given = self.server.place / "out", ["--instrument", self.server.instrument]
        page, files = RESULTS[self.what]
        if self.what == "correct":
            given += ["--out", str(out / "temperature.nc")]
        else:
            given += ["--radiance", str(self.server.radiance), "--out", str(out / "diagnosis")]
        status, said = self._command(self.what, str(self._folder), *given)
        self._say(200, {"said": said} | ({} if status else {"page": page, "files": files}))

    def _command(self, *words):
        """Exit status of a command and what it says, the copy's folder left out."""
        said = text_io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            status = cli.main(list(words))
        return status, said.getvalue().replace(str(self._folder), "test").strip()
