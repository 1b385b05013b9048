from __future__ import annotations

from collections.abc import Iterator
from hashlib import sha256
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

from relforest.datasets.download import data_file
from relforest.support.errors import DataError, MissingDataError

NAME = "bags.csv.gz"
RIGHT = b"the published bytes"
REGISTRY = {NAME: sha256(RIGHT).hexdigest()}


class Server:
    """A web server on this machine that serves what it is told and counts what is asked of it."""

    def __init__(self) -> None:
        self.files: dict[str, bytes] = {}
        self.asked: list[str] = []
        self.promised_too_much = 0
        outer = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                outer.asked.append(self.path)
                content = outer.files.get(self.path)
                if content is None:
                    self.send_error(404)
                    return
                self.send_response(200)
                self.send_header("Content-Length", str(len(content) + outer.promised_too_much))
                self.end_headers()
                self.wfile.write(content)

            def log_message(self, format: str, *args: object) -> None:
                """Keep quiet."""

        self._http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._thread = Thread(target=self._http.serve_forever, kwargs={"poll_interval": 0.01})
        self._thread.start()
        self.url = f"http://127.0.0.1:{self._http.server_port}/data"

    def stop(self) -> None:
        self._http.shutdown()
        self._thread.join()
        self._http.server_close()


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[Server]:
    for name in ("http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    made = Server()
    yield made
    made.stop()


@pytest.fixture(autouse=True)
def clean_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("RELFOREST_DATA", "RELFOREST_DATA_URL"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def cache(tmp_path: Path) -> Path:
    return tmp_path / "cache"


def get(cache: Path, url: str | None = None) -> tuple[Path, bytes]:
    return data_file(NAME, REGISTRY, data_home=cache, base_url=url, source="a cupboard")


def test_a_file_is_downloaded_once(server: Server, cache: Path) -> None:
    server.files[f"/data/{NAME}"] = RIGHT
    assert get(cache, server.url) == (cache / NAME, RIGHT)
    assert get(cache, server.url) == (cache / NAME, RIGHT)
    assert server.asked == [f"/data/{NAME}"]


def test_what_is_cached_needs_no_server_and_no_address(server: Server, cache: Path) -> None:
    server.files[f"/data/{NAME}"] = RIGHT
    get(cache, f"{server.url}/")
    server.stop()
    assert get(cache, server.url)[1] == RIGHT
    assert get(cache)[1] == RIGHT


def test_the_address_may_stand_in_the_environment(
    server: Server, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    server.files[f"/data/{NAME}"] = RIGHT
    monkeypatch.setenv("RELFOREST_DATA_URL", server.url)
    assert get(cache)[1] == RIGHT


def test_the_cache_is_among_the_users_caches_by_default(
    server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    server.files[f"/data/{NAME}"] = RIGHT
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    path, _ = data_file(NAME, REGISTRY, base_url=server.url, source="a cupboard")
    assert path == tmp_path / "relforest" / NAME


def test_what_the_server_does_not_have_is_reported(server: Server, cache: Path) -> None:
    with pytest.raises(DataError, match=rf"{NAME} could not .* {server.url} .*404.*Check the address"):
        get(cache, server.url)
    assert list(cache.glob("*")) == []


def test_a_server_that_is_not_there_is_reported(server: Server, cache: Path) -> None:
    server.stop()
    with pytest.raises(DataError, match=rf"could not be downloaded from {server.url}.*Check the address"):
        get(cache, server.url)
    assert list(cache.glob("*")) == []


def test_other_bytes_are_refused_and_not_kept(server: Server, cache: Path) -> None:
    server.files[f"/data/{NAME}"] = b"something else"
    found = sha256(b"something else").hexdigest()
    with pytest.raises(DataError, match=rf"{NAME} could not .*{REGISTRY[NAME]}.*{found}"):
        get(cache, server.url)
    assert list(cache.glob("*")) == []


def test_a_download_that_breaks_off_is_not_kept(server: Server, cache: Path) -> None:
    server.files[f"/data/{NAME}"] = RIGHT[:5]
    server.promised_too_much = len(RIGHT) - 5
    with pytest.raises(DataError, match=f"{NAME} could not be downloaded"):
        get(cache, server.url)
    assert list(cache.glob("*")) == []


def test_a_damaged_file_in_the_cache_is_fetched_anew(server: Server, cache: Path) -> None:
    server.files[f"/data/{NAME}"] = RIGHT
    cache.mkdir()
    (cache / NAME).write_bytes(b"half of")
    assert get(cache, server.url)[1] == RIGHT
    assert (cache / NAME).read_bytes() == RIGHT


def test_a_damaged_file_in_the_cache_is_refused_without_an_address(cache: Path) -> None:
    cache.mkdir()
    (cache / NAME).write_bytes(b"half of")
    found = sha256(b"half of").hexdigest()
    with pytest.raises(
        DataError,
        match=rf"{NAME} is not the published file.*{found}, expected is {REGISTRY[NAME]}; delete it",
    ):
        get(cache)


def test_a_missing_file_is_told_how_to_get(cache: Path) -> None:
    with pytest.raises(MissingDataError) as error:
        get(cache)
    for remedy in (
        f"looked in {cache}",
        "not available on the web yet",
        "RELFOREST_DATA to a folder with mil/bags.csv.gz",
        "base_url or in RELFOREST_DATA_URL",
        "read_csv, read_c45 or read_arff",
        "a cupboard",
    ):
        assert remedy in str(error.value)


@pytest.mark.parametrize("folder", ["mil", "."])
def test_a_folder_of_the_users_comes_first(
    server: Server, cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: str
) -> None:
    monkeypatch.setenv("RELFOREST_DATA", str(tmp_path))
    (tmp_path / folder).mkdir(exist_ok=True)
    (tmp_path / folder / NAME).write_bytes(RIGHT)
    assert get(cache, server.url) == (tmp_path / folder / NAME, RIGHT)
    assert server.asked == []


def test_what_the_folder_lacks_is_downloaded(
    server: Server, cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RELFOREST_DATA", str(tmp_path))
    server.files[f"/data/{NAME}"] = RIGHT
    assert get(cache, server.url)[0] == cache / NAME


def test_a_wrong_file_in_the_folder_is_refused(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RELFOREST_DATA", str(tmp_path))
    (tmp_path / NAME).write_bytes(b"mine")
    with pytest.raises(DataError, match=rf"{NAME} is not the published file.*replace it with the right file"):
        get(cache)


@pytest.mark.parametrize("url", ["ftp://127.0.0.1/data", "data", "file:///data"])
def test_only_web_addresses_are_accepted(cache: Path, url: str) -> None:
    with pytest.raises(DataError, match="must begin with http:// or https://"):
        get(cache, url)


def test_a_cache_that_cannot_be_written_is_reported(server: Server, tmp_path: Path) -> None:
    server.files[f"/data/{NAME}"] = RIGHT
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(DataError, match=f"{NAME} could not be downloaded"):
        get(tmp_path / "file" / "cache", server.url)
