"""Starts `breakaway watch` and looks at what it serves: with Python's own HTTP and JSON, and with Chromium.

Usage: watch_page.py CASE COMMAND SCENARIOS SCRATCH CHROMIUM; the cases of the browser are skipped (exit code 77) where
CHROMIUM is not there, and leave their pictures in SCRATCH.
"""

import base64
import contextlib
import csv
import http.client
import http.server
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

SKIPPED = 77
PATIENCE_S = 20


class Watch:
    """A running `breakaway watch` on a free port."""

    def __init__(self, command, *options, folder=None):
        self.process = subprocess.Popen([command, "watch", "--http", "0", *options], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True, cwd=folder)
        line = self.process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
        if not found:
            raise SystemExit(f"no address in {line!r}: {self.process.stderr.read()}")
        self.url, self.port, self.line = found.group(0), int(found.group(1)), line

    def get(self, path):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        connection.request("GET", path)
        answer = connection.getresponse()
        return answer.status, answer.read()

    def json(self, path):
        status, body = self.get(path)
        assert status == 200, (path, status)
        return json.loads(body)

    def wait_for(self, count):
        """Until so many samples came."""
        end = time.monotonic() + PATIENCE_S
        while self.json(f"/samples?from={count}")["next"] < count:
            assert time.monotonic() < end, f"fewer than {count} samples"
            time.sleep(0.002)

    def rows(self, count):
        """All rows, once there are so many."""
        fields = self.json("/about")["fields"]
        rows, excerpt = [], {"next": 0}
        end = time.monotonic() + PATIENCE_S
        while len(rows) < count and time.monotonic() < end:
            excerpt = self.json(f"/samples?from={excerpt['next']}")
            rows += [dict(zip(fields, row)) for row in excerpt["rows"]]
            if not excerpt["more"]:
                time.sleep(0.05)
        assert len(rows) == count, f"{len(rows)} rows, expected {count}"
        return rows, excerpt

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        out, err = self.process.communicate(timeout=PATIENCE_S)
        return self.process.returncode, err


@contextlib.contextmanager
def watching(command, *options, folder=None):
    watch = Watch(command, *options, folder=folder)
    try:
        yield watch
    finally:
        if watch.process.poll() is None:
            watch.process.kill()
            watch.process.wait()


def simulated(command, scenarios, scratch, scene="can_axis.toml"):
    run = pathlib.Path(scratch) / "run.csv"
    subprocess.run([command, "simulate", f"{scenarios}/{scene}", "--csv", run], check=True, stdout=subprocess.DEVNULL)
    with open(run, newline="", encoding="utf-8") as file:
        return run, list(csv.DictReader(file))


def case_file(command, scenarios, scratch, _):
    run, samples = simulated(command, scenarios, scratch)
    with open(run, "a", encoding="utf-8") as file:
        file.write("this is no sample\n")
    with watching(command, "--file", run) as watch:
        rows, excerpt = watch.rows(len(samples))
        modes = watch.json("/about")["modes"]
        for row, sample in zip(rows, samples):
            assert row["position_m"] == float(sample["position_m"]), (row, sample)
            assert row["time_s"] == float(sample["time_s"])
            assert modes[row["mode"]] == sample["mode"]
            assert row["command_N"] is None
        while excerpt["malformed"] == 0:
            excerpt = watch.json("/samples?from=0")
        assert excerpt["malformed"] == 1, excerpt["malformed"]
        expected = f"run.csv:{len(samples) + 2}: has 1 columns"
        assert expected in excerpt["complaint"], excerpt["complaint"]
        status, page = watch.get("/")
        assert status == 200 and b"<title>breakaway watch</title>" in page
        assert watch.get("/../../../../etc/passwd")[0] == 404
        time.sleep(0.5)
        code, err = watch.end()
        assert code == 0, (code, err)
        assert err.count("\n") == 1 and expected in err, err


def sample_bytes(number, axis, **fields):
    named = {f"{axis}/{name}": value for name, value in fields.items()}
    sample = {"timestamp": 1.7e9 + number / 1000, "sample": number, "dropped": 3, "latency_us": 5.5, **named}
    return json.dumps(sample).encode()


def case_stream(command, *_):
    with watching(command, "--stream", "0") as watch:
        port = int(re.search(r"UDP port (\d+)", watch.line).group(1))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for number in range(100):
                if number == 50:
                    sender.sendto(b"\x00\xff malformed", ("127.0.0.1", port))
                    continue
                axis = "xy"[number % 2]
                sender.sendto(sample_bytes(number, axis, position_m=number * 1e-3, target_m=0.5, mode=3, fault=9),
                              ("127.0.0.1", port))
            rows, excerpt = watch.rows(99)
        assert excerpt["axes"] == ["x", "y"]
        assert watch.json("/about")["faults"][rows[7]["fault"]] == "following error"
        assert rows[7]["position_m"] == 0.007 and rows[7]["axis"] == 1 and rows[7]["latency_us"] == 5.5
        assert (excerpt["malformed"], excerpt["lost_on_the_way"], excerpt["lost_at_sender"]) == (1, 1, 3), excerpt
        assert watch.end()[0] == 0


def refused(command, *options):
    ended = subprocess.run([command, "watch", *options], capture_output=True, text=True, timeout=PATIENCE_S)
    assert ended.returncode == 2, (options, ended)
    assert ended.stderr.count("\n") == 1, ended.stderr
    return ended.stderr


def case_refusals(command, scenarios, scratch, _):
    assert "give one of --stream" in refused(command)
    assert "give one of --stream" in refused(command, "--stream", "0", "--file", "run.csv")
    assert "No such file" in refused(command, "--file", "/nowhere/run.csv")
    assert "no column time_s" in refused(command, "--file", f"{scenarios}/can_axis.toml")
    assert "neither PORT nor ADDRESS:PORT" in refused(command, "--stream", "http")
    assert "--http" in refused(command, "--stream", "0", "--http", "65536")
    assert "leave --control out" in refused(command, "--stream", "0", "--control")
    assert "--can needs the node's file" in refused(command, "--can", "can0")
    assert "--can needs the node's file" in refused(command, "--stream", "0", f"{scenarios}/can_axis.toml")
    no_such = refused(command, "--can", "nothere0", f"{scenarios}/can_axis.toml")
    assert "nothere0: there is no such interface" in no_such or "no CAN sockets" in no_such, no_such
    assert "[loop]" in refused(command, "--can", "nothere0", f"{scenarios}/impulsive_example.toml")
    with watching(command, "--stream", "0") as watch:
        assert "--http PORT names another port" in refused(command, "--stream", "0", "--http", str(watch.port))
        taken = re.search(r"UDP port (\d+)", watch.line).group(1)
        assert "choose another port" in refused(command, "--stream", taken, "--http", "0")


class Browser:
    """Chromium without a window, told what to do over a pipe by its DevTools protocol."""

    def __init__(self, program, scratch):
        ours_in, theirs_out = os.pipe()
        theirs_in, ours_out = os.pipe()

        def as_chromium_wants_them():
            first, second = os.dup(theirs_in), os.dup(theirs_out)
            os.dup2(first, 3)
            os.dup2(second, 4)

        # Without a sandbox, which the root user of a container cannot have.
        self.process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
             "--remote-debugging-pipe", f"--user-data-dir={scratch}/profile"],
            preexec_fn=as_chromium_wants_them, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(theirs_in)
        os.close(theirs_out)
        self.pipe_in, self.pipe_out = os.fdopen(ours_in, "rb", buffering=0), os.fdopen(ours_out, "wb", buffering=0)
        self.rest, self.number, self.session, self.problems = b"", 0, None, []
        target = self.do("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.do("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.do(f"{domain}.enable")

    def message(self):
        while b"\0" not in self.rest:
            got = os.read(self.pipe_in.fileno(), 1 << 20)
            assert got, "the browser has ended"
            self.rest += got
        text, self.rest = self.rest.split(b"\0", 1)
        return json.loads(text)

    def do(self, method, **parameters):
        self.number += 1
        wish = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            wish["sessionId"] = self.session
        self.pipe_out.write(json.dumps(wish).encode() + b"\0")
        while True:
            told = self.message()
            if told.get("method") == "Runtime.exceptionThrown":
                self.problems.append(told["params"]["exceptionDetails"])
            if told.get("method") == "Log.entryAdded" and told["params"]["entry"]["level"] == "error":
                self.problems.append(told["params"]["entry"])
            if told.get("id") == self.number:
                assert "error" not in told, (method, told)
                return told["result"]

    def show(self, url, width=1280, height=1000, dark=False):
        self.do("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                mobile=width < 600)
        self.do("Emulation.setEmulatedMedia",
                features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        # A page whose address differs in its fragment only would not be loaded anew.
        self.do("Page.navigate", url="about:blank")
        self.do("Page.navigate", url=url)

    def value(self, expression):
        return self.do("Runtime.evaluate", expression=expression, returnByValue=True)["result"].get("value")

    def wait_for(self, expression):
        end = time.monotonic() + PATIENCE_S
        while not self.value(expression):
            assert time.monotonic() < end, (expression, self.value("document.body.innerText"), self.problems)
            time.sleep(0.05)

    def drag(self, selector, begin, end):
        """The mouse pressed from one share of the element's width to another."""
        box = self.value(f"(({{x, y, width, height}}) => ({{x, y, width, height}}))"
                         f"(document.querySelector('{selector}').getBoundingClientRect())")
        for kind, share in (("mousePressed", begin), ("mouseMoved", end), ("mouseReleased", end)):
            self.do("Input.dispatchMouseEvent", type=kind, x=box["x"] + share * box["width"],
                    y=box["y"] + box["height"] / 2, button="left", buttons=1, clickCount=1)

    def picture(self, path):
        self.value("window.scrollTo(0, 0)")
        shot = self.do("Page.captureScreenshot", format="png", captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(shot["data"]))
        assert path.stat().st_size > 10_000, path

    def end(self):
        self.process.kill()
        self.process.wait()


@contextlib.contextmanager
def browsing(program):
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
        browser = Browser(program, scratch)
        try:
            yield browser
            assert not browser.problems, browser.problems
        finally:
            browser.end()


def needs_browser(case):
    """Skips the case where there is no browser."""

    def guarded(command, scenarios, scratch, program):
        if program in ("", "BREAKAWAY_CHROMIUM-NOTFOUND"):
            print("skipped: chromium is not installed; apt-get install chromium")
            return SKIPPED
        return case(command, scenarios, scratch, program)

    return guarded


CELLS = "[...document.querySelectorAll('#axes tbody td')].map((cell) => cell.textContent)"
FIGURES = "[...document.querySelectorAll('figure')].filter((figure) => !figure.hidden).length"


@needs_browser
def case_browser(command, scenarios, pictures, program):
    pictures = pathlib.Path(pictures)
    with tempfile.TemporaryDirectory() as scratch, browsing(program) as browser:
        run, samples = simulated(command, scenarios, scratch)
        kicks = sum(after["mode"] == "kick" != before["mode"] for before, after in zip(samples, samples[1:]))
        assert kicks > 0
        with watching(command, "--file", run.name, folder=scratch) as watch:
            browser.show(watch.url)
            browser.wait_for(f"document.body.dataset.samples === '{len(samples)}'")
            cells = browser.value(CELLS)
            assert cells[2] == samples[-1]["mode"] and cells[6] == str(kicks), (cells, kicks)
            assert browser.value("document.getElementById('control').hidden")
            assert browser.value(FIGURES) == 5, "four, and the bus load that a simulation knows"
            browser.picture(pictures / "watch_wide.png")
            follow = "document.getElementById('follow').textContent"
            browser.drag("canvas", 0.8, 0.9)
            browser.wait_for(f"{follow} === 'Whole run'")
            browser.picture(pictures / "watch_enlarged.png")
            browser.value("document.querySelector('canvas').dispatchEvent(new MouseEvent('dblclick'))")
            browser.wait_for(f"{follow} === 'Pause'")
            for name, width, dark in (("narrow", 390, False), ("dark", 1280, True)):
                browser.show(watch.url, width=width, height=1100, dark=dark)
                browser.wait_for(f"document.body.dataset.samples === '{len(samples)}'")
                browser.picture(pictures / f"watch_{name}.png")
                assert browser.value("document.documentElement.scrollWidth <= innerWidth"), "nothing beyond the edge"
            watch.process.kill()
            browser.wait_for("document.getElementById('connection').className === 'lost'")
            browser.problems.clear()  # of the requests that nobody answers
    return 0


@needs_browser
def case_browser_live(command, _, pictures, program):
    with watching(command, "--stream", "0") as watch, browsing(program) as browser:
        port = int(re.search(r"UDP port (\d+)", watch.line).group(1))
        browser.show(watch.url)
        state = "document.getElementById('connection').textContent"
        browser.wait_for(f"{state} === 'waiting for samples'")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for number in range(2000):
                mode = 1 if number % 400 < 40 else 3
                error_m = 1e-3 * 0.997 ** (number % 400)
                fault = {"fault": 3, "fault_code": 0x2310} if number == 1999 else {"fault": 0, "fault_code": 0}
                sample = sample_bytes(number, "xy"[number % 2], position_m=0.25 + error_m, target_m=0.25, mode=mode,
                                      drive=3, command_N=mode * 2.0, reported_N=mode * 1.9, **fault)
                sender.sendto(sample, ("127.0.0.1", port))
                if number % 100 == 99:  # no more than what a socket holds, however busy this machine is
                    watch.wait_for(number + 1)
            sender.sendto(b"<script>document.title = 'taken'</script>", ("127.0.0.1", port))
        browser.wait_for("document.body.dataset.samples === '1000'")
        browser.wait_for(f"{state}.startsWith('no samples for ')")
        browser.wait_for("document.getElementById('losses').textContent.includes('1 could not be read')")
        cells = browser.value(CELLS)
        assert cells[:3] == ["x", "enabled", "hold"] and cells[8] == "y", cells
        assert cells[15] == "drive emergency, error code 2310h", cells
        fault = browser.value("document.getElementById('fault').textContent")
        assert "y: drive emergency" in fault and "an EMCY message with an error code" in fault, fault
        assert browser.value("document.title") == "breakaway watch"
        browser.value("document.querySelectorAll('#axes tbody tr')[1].click()")
        browser.wait_for("document.querySelector('#axes tr.chosen td').textContent === 'y'")
        assert browser.value(FIGURES) == 5, "four, and the latency that the stream tells"
        browser.picture(pathlib.Path(pictures) / "watch_live.png")
    return 0


class FakeNode(http.server.BaseHTTPRequestHandler):
    """A node with two axes that stand still, behind the real page: what is commanded is written down."""

    page, commands, polls = None, [], []
    refusal = None

    def answer(self, status, body, kind="application/json"):
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_GET(self):
        if self.path == "/about":
            about = {**self.page.json("/about"), "control": True, "live": True, "axes": ["x", "y"]}
            return self.answer(200, json.dumps(about).encode())
        if self.path.startswith("/samples"):
            self.polls.append(self.headers["X-Breakaway-Token"])
            # The axes were heard in the other order than they stand in the node.
            rows = [[place, time.time(), None, 0.1, None, 0, None, 0.2, 3, 1, 0, 0, 0, 0] for place in (0, 1)]
            told = {"next": 0, "more": False, "axes": ["y", "x"], "malformed": 0, "lost_on_the_way": 0,
                    "lost_at_sender": 0, "complaint": "", "rows": rows}
            return self.answer(200, json.dumps(told).encode())
        connection = http.client.HTTPConnection("127.0.0.1", self.page.port, timeout=PATIENCE_S)
        connection.request("GET", self.path)
        got = connection.getresponse()
        return self.answer(got.status, got.read(), got.headers["Content-Type"])

    def do_POST(self):
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.commands.append((self.path, self.headers["X-Breakaway-Token"], body))
        if FakeNode.refusal:
            return self.answer(409, json.dumps({"refused": FakeNode.refusal}).encode())
        return self.answer(200, b"{}")

    def log_message(self, *_):
        pass


@needs_browser
def case_browser_control(command, _, pictures, program):
    with watching(command, "--stream", "0") as watch, browsing(program) as browser:
        FakeNode.page = watch
        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), FakeNode) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            url = f"http://127.0.0.1:{server.server_port}/"
            browser.show(url)
            browser.wait_for("!document.getElementById('notice').hidden")
            assert browser.value("document.getElementById('control').hidden"), "no token, no control"
            browser.show(url + "#token=0123")
            browser.wait_for("!document.getElementById('control').hidden")
            browser.wait_for("document.querySelector('#axes td') !== null")
            click = "document.getElementById('{}').click()".format
            opened = "document.getElementById('confirm').open"

            browser.value(click("stop"))
            wait_for_commands(browser, 1)
            assert FakeNode.commands[-1] == ("/command", "0123", {"axis": 1, "action": "stop"}), "at once, of axis y"
            browser.value(click("enable"))
            browser.wait_for(opened)
            browser.picture(pathlib.Path(pictures) / "watch_control.png")
            browser.value("document.querySelector('#confirm button').click()")
            browser.wait_for(f"!{opened}")
            browser.value(click("enable"))
            browser.wait_for(opened)
            browser.value(click("stop"))
            wait_for_commands(browser, 2)
            assert not browser.value(opened), "a stop is in reach whatever is asked"
            assert FakeNode.commands[-1][2] == {"axis": 1, "action": "stop"}
            browser.value(click("enable"))
            browser.wait_for(opened)
            browser.value(click("yes"))
            wait_for_commands(browser, 3)
            assert FakeNode.commands[-1][2] == {"axis": 1, "action": "enable"}, "once: what was cancelled was not sent"
            for count, text, target_m in ((4, "-0.25", -0.25), (5, "1e-3", 1e-3), (6, "0,5", 0.5)):
                browser.value(f"document.getElementById('target').value = '{text}'")
                browser.value(click("go"))
                browser.wait_for(opened)
                browser.value(click("yes"))
                wait_for_commands(browser, count)
                assert FakeNode.commands[-1][2] == {"axis": 1, "action": "target", "target_m": target_m}
            for text in ("", "far", "1 2", "Infinity"):
                browser.value(f"document.getElementById('target').value = '{text}'")
                browser.value(click("go"))
                assert "no number" in browser.value("document.getElementById('answer').textContent"), text
                assert not browser.value(opened)
            browser.value("document.querySelectorAll('#axes tbody tr')[1].click()")
            FakeNode.refusal = "another commander speaks"
            browser.value(click("reset"))
            browser.wait_for(opened)
            browser.value(click("yes"))
            browser.wait_for("document.getElementById('answer').textContent === 'not done: another commander speaks'")
            assert FakeNode.commands[-1][2] == {"axis": 0, "action": "reset"}
            assert FakeNode.polls[-1] == "0123", "the page that commands shows that it is there"
            browser.problems.clear()  # of the request that was refused
            server.shutdown()
    return 0


def wait_for_commands(browser, count):
    end = time.monotonic() + PATIENCE_S
    while len(FakeNode.commands) < count:
        assert time.monotonic() < end, (FakeNode.commands, browser.problems)
        time.sleep(0.02)


def main():
    case, command, scenarios, scratch, program = sys.argv[1:]
    function = globals()[f"case_{case}"]
    if case.startswith("browser"):
        return function(command, scenarios, scratch, program)
    with tempfile.TemporaryDirectory() as folder:
        function(command, scenarios, folder, program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
