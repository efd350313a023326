"""A real browser for the web viewer: headless Chromium, spoken to through a pipe."""

import base64
import contextlib
import json
import os
import select
import signal
import subprocess
import tempfile
import time

FLAGS = (
    # Half a minute of machine code for a page that is looked at once is not worth while.
    "--js-flags=--wasm-lazy-compilation --no-wasm-tier-up",
    *("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"),
    *("--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-first-run", "--disable-background-networking"),
)


class Browser:
    """A page in Chromium: what it asks of the network, what it logs, what it shows."""

    def __init__(self, read, write):
        self._read, self._write = read, write
        self._number = 0
        self._rest = b""
        self.requests = {}
        self.blocked = set()
        self.console = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Log", "Network", "Page", "Runtime"):
            self.call(f"{domain}.enable", session=self._session)

    def call(self, method, session=None, **params):
        """Send a command and return its result."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            for answer in self._messages(1.0):
                if answer.get("id") == self._number:
                    if "error" in answer:
                        raise RuntimeError(f"{method}: {answer['error']}")
                    return answer["result"]
        raise TimeoutError(method)

    def _messages(self, seconds):
        if not select.select([self._read], [], [], seconds)[0]:
            return
        self._rest += os.read(self._read, 1 << 20)
        *whole, self._rest = self._rest.split(b"\0")
        for each in map(json.loads, whole):
            if each.get("method") == "Network.requestWillBeSent":
                self.requests[each["params"]["requestId"]] = each["params"]["request"]["url"]
            elif each.get("method") == "Network.loadingFailed" and each["params"].get("blockedReason") == "csp":
                self.blocked.add(each["params"]["requestId"])
            elif each.get("method") == "Runtime.exceptionThrown":
                self.console.append(each["params"]["exceptionDetails"].get("text", "an exception"))
            elif each.get("method") == "Log.entryAdded":
                self.console.append(each["params"]["entry"]["text"])
            elif each.get("method") == "Runtime.consoleAPICalled":
                self.console.append(" ".join(str(a.get("value", "")) for a in each["params"]["args"]))
            yield each

    def asked(self):
        """Return the addresses that the page was allowed to ask."""
        return sorted({url for number, url in self.requests.items() if number not in self.blocked})

    def open(self, url):
        """Load a page."""
        self.call("Page.navigate", session=self._session, url=url)

    def ask(self, script):
        """Evaluate JavaScript in the page and return its value."""
        answer = self.call("Runtime.evaluate", session=self._session, expression=script, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"])
        return answer["result"].get("value")

    def wait_for(self, script, seconds=30.0):
        """Wait until JavaScript in the page gives something true."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            if self.ask(script):
                return
            time.sleep(0.1)
        raise TimeoutError(f"{script} did not come true within {seconds:g} s")

    def media(self, **features):
        """Set media features, such as prefers_color_scheme."""
        told = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
        self.call("Emulation.setEmulatedMedia", session=self._session, features=told)

    def picture(self):
        """Return what the page shows as PNG bytes."""
        data = self.call("Page.captureScreenshot", session=self._session, format="png")["data"]
        return base64.b64decode(data)

    def at_rest(self):
        """Return a picture once there is something to see and two in a row are equal."""
        pictures = [b""]

        def rests(now):
            pictures.append(now)
            return now == pictures[-2] and len(now) > 60_000

        return self.until(rests)

    def until(self, shows, seconds=180.0):
        """Return the first picture in which there is what `shows` looks for; to take one is work for the page."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            time.sleep(1.5)
            try:
                now = self.picture()
            except RuntimeError as error:
                if "Not attached to an active page" not in str(error):  # between a blank page and that which was opened
                    raise
                continue
            if shows(now):
                return now
        raise TimeoutError(f"the page did not show it within {seconds:g} s; it said {self.console[-5:]}")


@contextlib.contextmanager
def chromium(program, size=(1600, 900)):
    """Start Chromium with a profile of its own and a window of that size; it ends with the context.

    A page of the viewer is drawn without a graphics card: a small window takes two thirds of the time.
    """
    to_read, write = os.pipe()
    read, to_write = os.pipe()

    def pipes():
        # The browser reads commands from descriptor 3 and answers on 4.
        first, second = os.dup(to_read), os.dup(to_write)
        os.dup2(first, 3)
        os.dup2(second, 4)

    # The processes that it starts may write to its profile a little longer than it lives itself.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        window = f"--window-size={size[0]},{size[1]}"
        command = [program, *FLAGS, "--remote-debugging-pipe", f"--user-data-dir={folder}", window]
        process = subprocess.Popen(
            command,
            preexec_fn=pipes,  # noqa: PLW1509 - nothing but four system calls happens between fork and exec
            close_fds=False,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        os.close(to_read)
        os.close(to_write)
        try:
            yield Browser(read, write)
        finally:
            process.terminate()
            process.wait(timeout=20)
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            os.close(read)
            os.close(write)
