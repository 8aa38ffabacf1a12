"""Clock levels, refresh rate and other settings that a run changes on the headset, and how they are restored.

Before anything is changed, what to restore is written to a file of this computer, one for each headset: a run that was
killed, or whose headset never came back, is put right by the next start or by --restore.
"""
import json
import os
import shlex
import sys

from .problems import Gone, Problem

OVR_METRICS = "com.oculus.ovrmonitormetricsservice"
PROPERTIES = (
    "debug.oculus.cpuLevel",
    "debug.oculus.gpuLevel",
    "debug.oculus.refreshRate",
    "debug.oculus.clockStateLogLevel",
)


def metrics_csv(on):
    return (
        f"am broadcast -n {OVR_METRICS}/.SettingsBroadcastReceiver "
        f"-a {OVR_METRICS}.{'ENABLE' if on else 'DISABLE'}_CSV"
    )


def worn(on):
    """Makes the headset believe that it is worn while it lies on the desk, or ask its sensor again."""
    return "am broadcast -a com.oculus.vrpowermanager." + ("prox_close" if on else "automation_disable")


def default_folder():
    return os.path.join(os.environ.get("XDG_STATE_HOME") or os.path.expanduser("~/.local/state"), "clothbench")


class Pins:
    """What this run changed on one headset."""

    def __init__(self, adb, folder):
        self.adb = adb
        self.file = os.path.join(folder, "quest-" + "".join(c if c.isalnum() else "-" for c in adb.serial) + ".json")

    def pending(self):
        return os.path.exists(self.file)

    def apply(self, cpu_level, gpu_level, refresh_hz):
        """Pins and checks what was pinned. `restore` must follow whatever happens."""
        before = {name: self.adb.shell("getprop " + name).strip() for name in PROPERTIES}
        os.makedirs(os.path.dirname(self.file), exist_ok=True)
        with open(self.file + ".tmp", "w", encoding="utf-8") as out:
            json.dump({"serial": self.adb.serial, "properties": before}, out)
            out.flush()
            os.fsync(out.fileno())
        os.replace(self.file + ".tmp", self.file)
        for name, value in zip(PROPERTIES, (cpu_level, gpu_level, f"{refresh_hz:g}", 1)):
            self._set(name, str(value))
        self.adb.shell(worn(True))
        self.adb.shell(
            metrics_csv(True), check=False
        )  # the tool may not be installed: its CSV is then missing, and said so

    def _set(self, name, value):
        self.adb.shell(f"setprop {name} {shlex.quote(value)}")
        got = self.adb.shell("getprop " + name).strip()
        if got != value:
            raise Problem(f"{name}: set to {value!r}, reads {got!r}")

    def restore(self, wait_s):
        """Restores all settings, and waits `wait_s` for a headset that does not answer. Raises Problem with the settings that are left."""
        if not self.pending():
            return
        with open(self.file, encoding="utf-8") as text:
            before = json.load(text)["properties"]
        steps = [(name, lambda n=name, v=value: self._set(n, v)) for name, value in before.items()]
        steps += [
            ("OVR Metrics CSV", lambda: self.adb.shell(metrics_csv(False), check=False)),
            ("proximity sensor", lambda: self.adb.shell(worn(False))),
        ]
        failed = []
        for what, step in steps:
            try:
                self._patiently(step, wait_s)
            except Gone:
                raise Gone(
                    f"the headset does not answer, so these settings are not restored ({', '.join(failed + [s[0] for s in steps])}). Plug it in and run "
                    f"quest_run.py --restore; a reboot of the headset resets the clock levels too"
                ) from None
            except Problem as e:
                failed.append(what)
                print(f"quest_run: restoring {what}: {e}", file=sys.stderr)
        if failed:
            raise Problem(f"not restored: {', '.join(failed)}; quest_run.py --restore tries again")
        os.remove(self.file)

    def _patiently(self, step, wait_s):
        try:
            step()
        except Gone:
            if not self.adb.wait(wait_s):
                raise
            step()
