"""adb: every command to the headset goes through Adb.call or Adb.stream."""
import os
import queue
import shutil
import subprocess
import threading
import time

from . import formats
from .problems import BadInput, Gone, NoDevice, Problem

# What adb says when the device itself is the trouble, not the command.
_GONE = (
    "no devices/emulators found",
    "device offline",
    "device not found",
    "error: closed",
    "protocol fault",
    "device still authorizing",
    "connection reset",
    "cannot connect to daemon",
)


def find_adb(given=None):
    """The adb to use. Raises BadInput if there is none."""
    candidates = (
        [given]
        if given
        else [shutil.which("adb")]
        + [
            os.path.join(os.environ[name], "platform-tools", "adb")
            for name in ("ANDROID_HOME", "ANDROID_SDK_ROOT")
            if os.environ.get(name)
        ]
    )
    for path in candidates:
        if path and shutil.which(path):
            return path
    raise BadInput(
        f"adb: {given or 'not on PATH and not under $ANDROID_HOME/platform-tools'}: no such program; "
        "install the Android platform tools (Debian: adb) or give --adb"
    )


class Adb:
    """One headset behind one adb program."""

    def __init__(self, program, serial=None):
        self.program, self.serial = program, serial

    def _words(self, words):
        return [self.program] + (["-s", self.serial] if self.serial else []) + [str(w) for w in words]

    def call(self, *words, timeout=30, check=True):
        """Text that the command printed, with plain line ends. Raises Gone, or Problem if it fails and `check`."""
        try:
            # A session of its own: Ctrl-C is ours to handle, not adb's.
            done = subprocess.run(
                self._words(words),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                timeout=timeout,
                start_new_session=True,
            )
        except subprocess.TimeoutExpired:
            raise Gone(f"adb {' '.join(map(str, words))}: no answer in {timeout:g} s") from None
        text, errors = (formats.plain(b.decode("utf-8", "replace")) for b in (done.stdout, done.stderr))
        if done.returncode != 0:
            first = next(
                (line for line in (errors + "\n" + text).splitlines() if line.strip()), f"exit status {done.returncode}"
            )
            low = errors.lower()
            if any(sign in low for sign in _GONE) or ("device '" in low and "not found" in low):
                raise Gone(f"the headset does not answer: {first}")
            if check:
                raise Problem(f"adb {' '.join(map(str, words))}: {first}")
        return text

    def shell(self, command, timeout=30, check=True):
        return self.call("shell", command, timeout=timeout, check=check)

    def stream(self, *words):
        return Stream(self._words(words))

    def choose(self):
        """Chooses the headset. Raises NoDevice if none is ready or --serial names none, BadInput if several are ready."""
        listed = formats.devices(Adb(self.program).call("devices", "-l"))
        ready = [d for d in listed if d[1] == "device"]
        if self.serial:
            state = dict((d[0], d[1]) for d in listed).get(self.serial)
            if state is None:
                raise NoDevice(
                    f"--serial {self.serial}: expected one of the devices that adb finds ({', '.join(d[0] for d in listed) or 'none'})"
                )
            if state != "device":
                raise NoDevice(f"{self.serial} is {state}{_hint(state)}")
            return
        if not ready:
            states = "; ".join(f"{d[0]} is {d[1]}{_hint(d[1])}" for d in listed)
            raise NoDevice(
                states or "adb finds no device: plug the headset in, enable developer mode, and allow USB debugging"
            )
        if len(ready) > 1:
            raise BadInput(
                "several devices are plugged in; choose one with --serial: " + ", ".join(f"{d[0]} ({d[2] or 'unknown'})" for d in ready)
            )
        self.serial = ready[0][0]

    def wait(self, seconds, tick=0.5):
        """True once the headset answers (again), False after `seconds`."""
        end = time.monotonic() + seconds
        while True:
            try:
                if self.call("get-state", timeout=5, check=False).strip() == "device":
                    return True
            except Gone:
                pass
            if time.monotonic() >= end:
                return False
            time.sleep(tick)


def _hint(state):
    return {"unauthorized": ": allow USB debugging in the headset", "offline": ": plug it in again"}.get(state, "")


class Stream:
    """A command that prints continuously. Each line has the host's time of its arrival."""

    def __init__(self, words):
        self._process = subprocess.Popen(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True
        )
        self._lines = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for raw in self._process.stdout:
            self._lines.put((time.time(), formats.plain(raw.decode("utf-8", "replace")).rstrip("\n")))

    def take(self):
        """Lines since the last call."""
        out = []
        while True:
            try:
                out.append(self._lines.get_nowait())
            except queue.Empty:
                return out

    def ended(self):
        return self._process.poll() is not None

    def stop(self):
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
