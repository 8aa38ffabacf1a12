"""scripts/quest_run.py with fake_adb.py as headset: whatever happens, the headset's settings end as they were.

usage: check_driver.py CLOTHBENCH MAKE_SAMPLE
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
DRIVER = os.path.join(HERE, "..", "..", "scripts", "quest_run.py")
CLOTHBENCH, MAKE_SAMPLE = sys.argv[1:3]
NAMES = [f"debug.oculus.{name}" for name in ("cpuLevel", "gpuLevel", "refreshRate", "clockStateLogLevel")]
BEFORE, FIXED, RESET = (dict(zip(NAMES, values)) for values in (("", "2", "90", ""), ("4", "4", "72", "1"), ("", "", "", "")))
RUNS = "/sdcard/Android/data/org.clothbench.quest/files/runs/table3-20260101T000000Z"


class Driver(unittest.TestCase):
    def setUp(self):
        self.home = tempfile.mkdtemp(prefix="clothbench-quest-")
        self.addCleanup(shutil.rmtree, self.home, ignore_errors=True)
        self.out = os.path.join(self.home, "out")
        os.mkdir(os.path.join(self.home, "bin"))
        os.symlink(os.path.join(HERE, "fake_adb.py"), os.path.join(self.home, "bin", "adb"))

    def start(self, *words, **plan):
        with open(os.path.join(self.home, "plan.json"), "w", encoding="utf-8") as out:
            json.dump({"props": BEFORE, "make_sample": MAKE_SAMPLE, "run_s": 2.2, "runs": RUNS, **plan}, out)
        env = {**os.environ, "FAKE_ADB": self.home, "PATH": os.path.join(self.home, "bin") + ":" + os.environ["PATH"]}
        return subprocess.Popen([sys.executable, "-S", DRIVER, "--clothbench", CLOTHBENCH, *words], env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def drive(self, *words, **plan):
        process = self.start(*words, **plan)
        self.text, _ = process.communicate(timeout=120)
        return process.returncode

    def run_app(self, *words, **plan):
        return self.drive("run", "study table3", "--out", self.out, "--settle-s", "0.2", *words, **plan)

    def world(self):
        with open(os.path.join(self.home, "world.json"), encoding="utf-8") as text:
            return json.load(text)

    def assert_restored(self):
        self.assertEqual((self.world()["props"], self.world()["worn"]), (BEFORE, False), self.text)
        environment = f"FAKE_ADB={self.home}".encode()
        left = []
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{pid}/environ", "rb") as text:
                    left += [pid] if environment in text.read().split(b"\0") else []
            except OSError:
                continue
        self.assertEqual(left, [], "no adb is left running")

    def test_a_run_from_end_to_end(self):
        import h5py

        self.assertEqual(self.drive("install", "x.apk"), 0, self.text)
        self.assertEqual(self.drive("push", "a.json", "b.json"), 0, self.text)
        self.assertEqual(self.drive("run", "study table3 --set 'a b'", "--out", self.out, "--settle-s", "0.2", clock_ahead_s=3.5), 0, self.text)
        self.assert_restored()
        self.assertEqual(self.world()["extra"], "'study table3 --set '\"'\"'a b'\"'\"''", "the device's shell hands on one argument")
        with open(os.path.join(self.home, "calls.log"), encoding="utf-8") as text:
            sets = [call[-1].split()[1:] for call in map(json.loads, text) if call[-1].startswith("setprop")]
        self.assertEqual(sets[:4], [[k, v] for k, v in FIXED.items()])
        with h5py.File(os.path.join(self.out, "table3-20260101T000000Z", "sample__none__readback=blocking.h5")) as f:
            group, summary = f["device_samples"], f["summary"].attrs
            self.assertEqual((group.attrs["valid"], group.attrs["reasons"]), (1, ""))
            read, trial = (group["ovrgpuprofiler"][name][:] for name in ("Read_Total_Bytes_per_sec", "trial"))
            self.assertGreater((trial >= 0).sum(), 2, "trials of 0.4 s contain samples of 0.1 s")
            self.assertTrue((trial < 0).any(), "a sample between trials counts for none")
            self.assertEqual((read[0], summary["sampled_read_mean_B_per_s"], summary["sampled_write_mean_B_per_s"]), (2.8e9, 2.8e9, 1.9e9))
            self.assertEqual((summary["sampled_fps_mean"], summary["sampled_gpu_clock_mean_Hz"]), (72, 545e6))
            start, end = f["timing/trial_start_unix_s"][0], f["timing/trial_end_unix_s"][2]
            for name in group:
                t = group[name]["time_unix_s"][:]
                self.assertTrue((t[1:] > t[:-1]).all() and t[0] > start - 5 and t[-1] < end + 5, name)

    def test_the_import_says_what_is_wrong_with_samples(self):
        raw, file = os.path.join(self.home, "raw"), os.path.join(self.home, "samples.json")
        subprocess.run([MAKE_SAMPLE, raw, "1.7e9"], check=True, stdout=subprocess.DEVNULL)
        series = {"name": "a", "units": "1", "long_name": "a", "values": [1, None]}
        for pointer, top, group, column in (
            ("/format", {"format": "x"}, {}, {}),
            ("/valid", {"valid": False}, {}, {}),
            ("/groups/0/name", {}, {"name": "a/b"}, {}),
            ("/groups/0/period_s", {}, {"period_s": 0}, {}),
            ("/groups/0/time_unix_s/1", {}, {"time_unix_s": [2, 1]}, {}),
            ("/groups/0/series/0/values", {}, {}, {"values": [1]}),
            ("/groups/0/series/0/values/0", {}, {}, {"values": ["1", 2]}),
            (None, {}, {}, {}),
        ):
            group = {"name": "g", "source": "s", "period_s": 1, "time_unix_s": [1, 2], "series": [{**series, **column}], **group}
            with open(file, "w", encoding="utf-8") as out:
                json.dump({"format": "clothbench-device-samples", "format_version": 1, "valid": True, "reasons": [], "device": {}, "groups": [group], **top}, out)
            done = subprocess.run([CLOTHBENCH, "import", raw, "--samples", file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            self.assertEqual(done.returncode, 0 if pointer is None else 2, done.stdout)
            self.assertIn(f"samples.json: {pointer}: expected" if pointer else ".h5", done.stdout)

    def test_clocks_that_moved_are_in_the_report(self):
        self.assertEqual(self.run_app(moves_after_s=1.0), 1, self.text)
        self.assert_restored()
        self.assertIn("NOT VALID: gpu clock MHz: 456 to 545; expected within 2% of the median", self.text)
        report = os.path.join(self.home, "report")
        path = os.path.join(self.out, "table3-20260101T000000Z", "sample__none__readback=blocking.h5")
        subprocess.run([CLOTHBENCH, "report", path, "-o", report], check=True, capture_output=True)
        with open(os.path.join(report, "report.md"), encoding="utf-8") as text:
            self.assertRegex(text.read(), r"\*\*Not a valid measurement: .*gpu clock MHz: 456 to 545")

    def test_no_profiler_and_no_log_of_clocks(self):
        self.assertEqual(self.run_app(profiler=False, vrapi=False), 1, self.text)
        self.assertIn("gpu level: the device did not report it", self.text)
        self.assert_restored()

    def test_what_ends_a_run_before_it_starts(self):
        two = [["A1", "device"], ["B2", "device"]]
        for code, words, plan in (
            (3, "no headset  is ready; adb lists: nothing", {"devices": []}),
            (3, "adb lists: A1 unauthorized", {"devices": [["A1", "unauthorized"]]}),
            (2, "choose one with --serial: A1, B2", {"devices": two}),
            (2, "is not installed", {"installed": False}),
        ):
            self.assertEqual(self.run_app(**plan), code, self.text)
            self.assertIn(words, self.text)
            self.assertFalse(os.path.exists(os.path.join(self.home, "world.json")), "no setting was changed")
        self.assertEqual(self.drive("--serial", "C3", "logs", devices=two), 3, self.text)
        self.assertEqual(self.drive("install", "x.apk", install_fails=True), 1)
        self.assertIn("INSUFFICIENT_STORAGE", self.text)

    def test_what_ends_a_run_early(self):
        for words, plan, options in (
            ("No space left on device", {"pull_fails": True}, ()),
            ("SIGSEGV", {"crash_after_s": 0.6, "run_s": 1e9}, ()),
            ("the app did not start", {"start_fails": True}, ()),
            ("did not end within 1.5 s", {"run_s": 1e9}, ("--timeout-s", "1.5")),
            ("Failed to set property", {"refused_props": ["debug.oculus.refreshRate"]}, ()),
            ("FAILED: ", {"result": "FAIL"}, ()),
        ):
            self.assertEqual(self.run_app(*options, **plan), 1, self.text)
            self.assertIn(words, self.text)
            if "refused_props" not in plan:
                self.assert_restored()
            shutil.rmtree(self.out)
            os.remove(os.path.join(self.home, "world.json"))

    def test_unplugged_then_restored_and_pulled(self):
        self.assertEqual(self.run_app(unplugged_after_s=0.8), 3, self.text)
        self.assertIn("quest_run.py restore", self.text)
        self.assertEqual(self.world()["props"], FIXED)
        self.assertEqual(self.drive("restore"), 0, self.text)
        self.assertEqual((self.world()["props"], self.world()["worn"]), (RESET, False))
        self.assertEqual(self.drive("pull", "--out", os.path.join(self.home, "later")), 0, self.text)
        self.assertTrue(os.path.exists(os.path.join(self.home, "later/runs/one/sample__none__readback=blocking.h5")), self.text)

    def test_interrupted(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start("run", "study table3", "--out", self.out, run_s=1e9)
            for _ in range(600):
                if os.path.exists(os.path.join(self.home, "world.json")) and self.world()["started"]:
                    break
                time.sleep(0.05)
            time.sleep(0.3)
            process.send_signal(number)
            time.sleep(0.2)
            process.send_signal(number)  # an impatient user
            self.text, _ = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 130, self.text)
            self.assert_restored()
            self.assertIsNotNone(self.world()["stopped"], "the app was stopped")
            os.remove(os.path.join(self.home, "world.json"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
