"""Follows one run of the app: log, counters, battery, and faults during the run."""
import time

from . import formats
from .problems import Gone, Problem

PACKAGE = "org.clothbench.quest"
_CRASH_POLLS = 2  # the process may end a moment before its last log line arrives


class AppFailed(Problem):
    """The app crashed or never ended."""


class Follower:
    """Samples by the device's clock: `offset_s` is what it is ahead of this computer's."""

    def __init__(self, adb, options, offset_s, metric_ids):
        self.adb, self.options, self.offset_s = adb, options, offset_s
        self.metrics = [metric_ids[name] for name in formats.WANTED if name in metric_ids]
        self.vrapi, self.battery, self.gaps, self.log = [], [], [], []
        self.result = None
        self._blocks = formats.GpuBlocks()
        self._last_log_s = self._logcat = self._profiler = None

    def profiler_samples(self):
        return [(when + self.offset_s, values) for when, values in self._blocks.samples]

    def start_streams(self):
        # From now on, or after a gap from a little before it broke off: the app's last line must not be missed.
        since = "1" if self._last_log_s is None else f"{self._last_log_s - 2:.3f}"
        self._logcat = self.adb.stream(
            "logcat", "-v", "epoch", "-T", since, "-s", "clothbench", "VrApi", "XrPerformanceManager"
        )
        if self.metrics:
            # On a terminal, so that the profiler ends when the connection does.
            self._profiler = self.adb.stream(
                "shell", "-tt", "ovrgpuprofiler -r" + '"' + ",".join(map(str, self.metrics)) + '"'
            )

    def stop_streams(self):
        for stream in (self._logcat, self._profiler):
            if stream:
                stream.stop()
        self._take()
        self._logcat = self._profiler = None

    def until_result(self, started_unix_s):
        """Returns when the app has logged its result. Raises AppFailed, or Gone if the headset does not come back."""
        missing, next_poll, end = 0, 0.0, time.monotonic() + self.options.timeout_s
        while self.result is None:
            self._take(started_unix_s)
            if time.monotonic() > end:
                raise AppFailed(f"the app did not end within {self.options.timeout_s:g} s (--timeout-s)")
            if time.monotonic() >= next_poll:
                try:
                    missing = 0 if self._poll() else missing + 1
                    if self._logcat.ended():
                        self._patch(time.time())
                except Gone:
                    self._patch(time.time())
                    missing = 0
                next_poll = time.monotonic() + self.options.poll_s
            if self.result is None and missing >= _CRASH_POLLS:
                raise AppFailed("the app ended without a result: it crashed or was closed" + self._crash_text())
            time.sleep(0.05)

    def _take(self, since=float("-inf")):
        for when, line in self._logcat.take() if self._logcat else ():
            entry = formats.logcat(line)
            # Processes' lines come a little out of order; what came before a gap comes again after it.
            if entry is None or (
                self._last_log_s is not None and entry[0] <= self._last_log_s and line in self.log[-1000:]
            ):
                continue
            stamp, tag, message = entry
            self._last_log_s = max(stamp, self._last_log_s or stamp)
            self.log.append(line)
            if tag == "VrApi" and (values := formats.vrapi(message)):
                self.vrapi.append((stamp, values))
            if tag == "clothbench" and stamp >= since:
                print(f"  {message}", flush=True)
                self.result = formats.result(message) or self.result
        for when, line in self._profiler.take() if self._profiler else ():
            self._blocks.feed(when, line)

    def _poll(self):
        """Battery and heat; true while the app runs."""
        now = time.time() + self.offset_s
        values = formats.battery(self.adb.shell("dumpsys battery", timeout=10))
        if values["powered"] is not None:
            values["powered"] = float(values["powered"])
        values["thermal_status"] = formats.thermal_status(
            self.adb.shell("dumpsys thermalservice", timeout=10, check=False)
        )
        self.battery.append((now, values))
        return bool(self.adb.shell(f"pidof {PACKAGE}", timeout=10, check=False).strip())

    def _patch(self, since):
        """Waits for a headset that was unplugged, then continues. The app runs without the cable."""
        print("  the headset does not answer; waiting for it (the app continues without the cable)", flush=True)
        self.stop_streams()
        if not self.adb.wait(self.options.wait_s):
            raise Gone(
                f"the headset stopped answering during the run and did not answer again within {self.options.wait_s:g} s (--wait-s)"
            )
        self.gaps.append(f"the headset did not answer for {time.time() - since:.1f} s: samples are missing")
        self.start_streams()

    def _crash_text(self):
        try:
            lines = (
                self.adb.call("logcat", "-b", "crash", "-d", "-t", "40", check=False, timeout=10).strip().splitlines()
            )
        except Gone:
            return ""
        return ":\n" + "\n".join(lines[-12:]) if lines else ""
