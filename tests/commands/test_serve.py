"""`plasmapyro serve`: what a browser may ask, what nobody else may, and a folder dropped in a real one."""

import http.client
import json
import threading
from pathlib import Path
from urllib.parse import quote, urlsplit

import laboratory
import pytest

from plasmapyro import cli
from plasmapyro.commands import serve

PHONE, DESKTOP = 390, 1280


@pytest.fixture(scope="module")
def shelf(tmp_path_factory):
    place = tmp_path_factory.mktemp("shelf")
    laboratory.calibration_folder(place / "raw")
    assert cli.main(["calibrate", str(place / "raw"), "--out", str(place / "lab")]) == 0
    laboratory.test_folder(place / "my_test")
    (place / "my_test" / "test.yaml").unlink()
    return place


@pytest.fixture
def served(shelf):
    """A running server and its address."""
    with serve.server(shelf / "lab") as (server, address):
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield server, address
        server.shutdown()
        thread.join()
    assert not server.place.exists()


def ask(address, method, path, body=None, **headers):
    """Status, headers and content of an answer; `path` after the token, or from the root with a slash."""
    parts = urlsplit(address)
    connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=60)
    place = path if path.startswith("/") else parts.path + path
    connection.request(method, place, body, {"Host": parts.netloc} | headers)
    answer = connection.getresponse()
    return answer.status, answer.headers, answer.read()


def test_only_this_machine_with_the_token_gets_an_answer(served):
    server, address = served
    assert server.server_address[0] == "127.0.0.1" and len(server.token) >= 40
    status, headers, page = ask(address, "GET", "")
    assert status == 200 and b"Drop the folder" in page
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy and "'self'" in policy and "http" not in policy
    assert b"http:" not in page and b"https:" not in page
    for path in ("/", "/x/", f"/{server.token[:-1]}/", f"/{'e' * 43}/result/temperature.nc", "//", "/%00/"):
        assert ask(address, "GET", path)[0] == 403, path
    assert ask(address, "GET", "", Host="evil.example")[0] == 403  # another name of this machine
    assert ask(address, "POST", "reset", Origin="http://evil.example")[0] == 403
    assert ask(address, "POST", "reset", Origin=address.split("/")[2].join(["http://", ""]))[0] == 200


HOSTILE = [
    *("../evil", "a/../../evil", "/etc/evil", "..", ".", "", ".bashrc", "a/.git/config", "C:evil"),
    *("a\\..\\evil", "con", "NUL.txt", "a/aux.csv", "x\n", "x\0y", "x.", "x ", "a//b", "a/b/c/d/e"),
    *("y" * 201, "<b>", 'q"', "a|b", "\u202ex"),
]


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_name_writes_nothing(served, name):
    server, address = served
    status, _, said = ask(address, "PUT", "file?name=" + quote(name, safe=""), b"evil")
    assert status == 400 and b"this name is not taken" in said
    assert not [path for path in server.place.rglob("*") if path.is_file()]


def test_what_is_too_large_is_refused_before_it_is_read(served, monkeypatch):
    server, address = served
    monkeypatch.setattr(serve, "LARGEST_FILE", 10)
    monkeypatch.setattr(serve, "LARGEST_FOLDER", 15)
    monkeypatch.setattr(serve, "MOST_FILES", 2)
    for length in ("11", "-1", "\u00b2".encode().decode("latin-1"), "1e3", ""):
        assert ask(address, "PUT", "file?name=a", b"", **{"Content-Length": length})[0] == 413
    assert ask(address, "PUT", "file?name=a", b"x" * 10)[0] == 200
    assert ask(address, "PUT", "file?name=b", b"x" * 10)[0] == 400  # more than a folder may have
    assert ask(address, "PUT", "file?name=b", b"x")[0] == 200
    assert ask(address, "PUT", "file?name=c", b"x")[0] == 400
    assert sorted(path.name for path in (server.place / "test").iterdir()) == ["a", "b"]


def test_results_are_those_of_the_list_and_nothing_else(served):
    server, address = served
    (server.place / "secret").write_text("secret")
    for name in ("result/../secret", "result/%2e%2e/secret", "result/", "result/test.yaml", "secret", "file"):
        status, _, content = ask(address, "GET", name)
        assert status == 404 and b"secret" not in content.replace(b"no such", b"")


def test_a_dropped_folder_is_described_checked_and_corrected(shelf, served):
    server, address = served
    for path in sorted((shelf / "my_test").rglob("*")):
        if path.is_file():
            name = path.relative_to(shelf / "my_test").as_posix()
            assert ask(address, "PUT", "file?name=" + quote(name), path.read_bytes())[0] == 200
    found = json.loads(ask(address, "POST", "check")[2])
    assert "can be processed" in found["said"] and "? attributes.emittance" in found["yaml"]
    assert str(server.place) not in found["said"]
    found = json.loads(ask(address, "POST", "correct")[2])
    assert found.get("page") == "temperature.html", found["said"]
    assert "highest at" in found["said"]
    status, headers, page = ask(address, "GET", "result/temperature.html")
    assert status == 200 and headers["Content-Security-Policy"].startswith("sandbox;")
    assert b"Temperature of the surface" in page
    assert ask(address, "GET", "result/temperature.nc")[2].startswith(b"\x89HDF")
    assert json.loads(ask(address, "POST", "reset")[2]) == {"said": ""}
    assert ask(address, "GET", "result/temperature.html")[0] == 404


@pytest.mark.parametrize(
    "content", [b"", b"\x00\xff", b"attributes: [", b"attributes: &a [*a]\n", b"pyrometer: {file: ../../x}\n"]
)
def test_hostile_descriptions_end_in_words(served, content):
    server, address = served
    ask(address, "PUT", "file?name=test.yaml", content)
    status, _, said = ask(address, "POST", "check")
    assert status == 200 and b"Traceback" not in said and b"fault of the program" not in said
    assert b"plasmapyro: " in said and str(server.place).encode() not in said


@pytest.mark.parametrize("width", [PHONE, DESKTOP])
def test_in_a_browser_a_folder_becomes_a_temperature(shelf, served, browser, width, tmp_path):
    from selenium.webdriver.support.ui import WebDriverWait

    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width == PHONE}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.get(served[1])
    forbidden = tmp_path / "other"
    forbidden.mkdir()
    (forbidden / "<img src=x>.csv").write_text("t;S1\n")
    find = browser.find_element
    find("id", "folder").send_keys(str(Path(shelf / "my_test")))
    wait = WebDriverWait(browser, 120)
    wait.until(lambda _: "can be processed" in find("id", "said").text)
    assert "emittance: 0.85" in find("id", "yaml").get_attribute("value")
    find("id", "correct").click()
    wait.until(lambda _: find("id", "result").is_displayed())
    assert "highest at" in find("id", "said").text
    assert browser.execute_script("return document.documentElement.scrollWidth") <= width
    names = [
        link.get_attribute("href").rpartition("/")[2]
        for link in find("id", "links").find_elements("tag name", "a")
    ]
    assert names == ["temperature.nc", "temperature.html"]
    browser.switch_to.frame(find("id", "page"))
    wait.until(lambda _: "What was refused, and why" in browser.find_element("tag name", "body").text)
    browser.switch_to.default_content()
    find("id", "yaml").send_keys(" [")  # a result of before would be taken for that of this description
    find("id", "correct").click()
    wait.until(lambda _: "test.yaml" in find("id", "said").text)
    assert not find("id", "result").is_displayed() and find("id", "described").is_displayed()
    severe = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert not [entry for entry in severe if "favicon" not in entry["message"]]
    browser.execute_script("document.getElementById('folder').value = ''")
    find("id", "folder").send_keys(str(forbidden))
    wait.until(lambda _: "this name is not taken" in find("id", "said").text)
    assert not find("id", "described").is_displayed()
    browser.get_log("browser")  # the refusal is none of the next test
