"""Headless Chromium that a script drives through a pipe, with processor times of pages.

Messages are those of the Chrome DevTools Protocol: JSON that ends with a zero byte.
"""

import fcntl
import itertools
import json
import os
import shutil
import subprocess
import sys
import tempfile

# Gives two open files the numbers 3 and 4, where Chromium reads and writes messages
LAUNCH = (
    "import os, sys; os.dup2(int(sys.argv[1]), 3); os.dup2(int(sys.argv[2]), 4);"
    "os.execv(sys.argv[3], sys.argv[3:])"
)
FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic"),
    *("--no-first-run", "--disable-background-networking", "--hide-scrollbars"),
    *("--disable-component-update", "--disable-sync", "--remote-debugging-pipe"),
)


class Page:
    """A page in a browser of its own; close it by `with`."""

    def __init__(self):
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        command = shutil.which("chromium") or shutil.which("google-chrome")
        self._in, write = os.pipe()
        read, self._out = os.pipe()
        given = [fcntl.fcntl(each, fcntl.F_DUPFD, 10) for each in (read, write)]
        words = [command, *FLAGS, f"--user-data-dir={self._profile.name}"]
        self._browser = subprocess.Popen(
            [sys.executable, "-c", LAUNCH, *map(str, given), *words],
            pass_fds=given,
            stderr=subprocess.DEVNULL,
        )
        for each in (read, write, *given):
            os.close(each)
        self._numbers = itertools.count(1)
        self._rest = b""
        self._session = None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        found = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = found["sessionId"]
        self.call("Page.enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._browser.terminate()
        self._browser.wait()
        os.close(self._in)
        os.close(self._out)
        self._profile.cleanup()

    def call(self, method, **parameters):
        """Call a method of the protocol; return its result."""
        number = next(self._numbers)
        message = {"id": number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._out, data) :]
        while True:
            answer = self._message()
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(answer["error"]["message"])
                return answer["result"]

    def _message(self):
        while b"\0" not in self._rest:
            block = os.read(self._in, 1 << 16)
            if not block:
                raise RuntimeError("Chromium has ended")
            self._rest += block
        one, self._rest = self._rest.split(b"\0", 1)
        return json.loads(one)

    def evaluate(self, script):
        """Return what a script, the body of an asynchronous function, returns."""
        found = self.call(
            "Runtime.evaluate",
            expression=f"(async () => {{ {script} }})()",
            awaitPromise=True,
            returnByValue=True,
        )
        if "exceptionDetails" in found:
            raise RuntimeError(str(found["exceptionDetails"]))
        return found["result"].get("value")

    def processor_time(self):
        """Processor time of the page's main thread so far [s]."""
        found = self.call("Performance.getMetrics")["metrics"]
        return next(m["value"] for m in found if m["name"] == "TaskDuration")
