"""scripts/quest_run.py with fake_adb.py as headset: whatever happens, the headset's settings end as they were.

usage: check_driver.py CLOTHBENCH MAKE_SAMPLE
"""
import csv
import json
import os
import pathlib
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
RUNS = "/sdcard/Android/data/org.clothbench.quest/files/runs"


class Driver(unittest.TestCase):
    def setUp(self):
        self.home = tempfile.mkdtemp(prefix="clothbench-quest-")
        self.addCleanup(shutil.rmtree, self.home, ignore_errors=True)
        self.out = os.path.join(self.home, "out")
        os.mkdir(os.path.join(self.home, "bin"))

    def start(self, *words, **plan):
        with open(os.path.join(self.home, "plan.json"), "w", encoding="utf-8") as out:
            json.dump({"props": BEFORE, "make_sample": MAKE_SAMPLE, "run_s": 2.2, **plan}, out)
        for program in ("adb", *(["hzdb"] if "hzdb" in plan else [])):
            if not os.path.islink(os.path.join(self.home, "bin", program)):
                os.symlink(os.path.join(HERE, "fake_adb.py"), os.path.join(self.home, "bin", program))
        env = {**os.environ, "HOME": self.home, "FAKE_ADB": self.home, "PATH": os.path.join(self.home, "bin") + ":" + os.environ["PATH"]}
        return subprocess.Popen([sys.executable, "-S", DRIVER, "--clothbench", CLOTHBENCH, *words], env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def drive(self, *words, **plan):
        process = self.start(*words, **plan)
        self.text, _ = process.communicate(timeout=120)
        return process.returncode

    def run_app(self, *words, **plan):
        return self.drive("run", "study table3", "--out", self.out, *words, **plan)

    def result(self):
        return next(pathlib.Path(self.out).glob("study-table3*/*.h5"))

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

        for by in ("ovrgpuprofiler", "perfetto", "hzdb"):
            source = "perfetto" if by == "hzdb" else by
            self.out = os.path.join(self.home, by)
            plan = {"clock_ahead_s": 3.5, "perfetto": by == "perfetto", **({"hzdb": "there"} if by == "hzdb" else {})}
            self.assertEqual(self.drive("run", "study table3 --set 'a b'", "--out", self.out, **plan), 0, self.text)
            self.assert_restored()
            self.assertRegex(self.world()["extra"], f"""^'study table3 --set '"'"'a b'"'"' --out {RUNS}/study-table3-set-a-b--20[0-9]{{6}}T[0-9]{{6}}Z'$""", "one argument for the device's shell")
            with open(os.path.join(self.home, "calls.log"), encoding="utf-8") as text:
                sets = [call[-1].split()[1:] for call in map(json.loads, text) if call[-1].startswith("setprop")]
            self.assertEqual(sets[:4], [[k, v] for k, v in FIXED.items()])
            with h5py.File(self.result()) as f:
                group, summary = f["device_samples"], f["summary"].attrs
                self.assertEqual((group.attrs["valid"], group.attrs["reasons"]), (1, "{}"))
                self.assertEqual(set(group), {"vrapi", source})
                read, trial = (group[source][name][:] for name in ("Read_Total_Bytes_per_sec", "trial"))
                self.assertGreater((trial >= 0).sum(), 90 if source == "perfetto" else 5, "three trials of 0.4 s contain samples of 0.01 or 0.05 s")
                self.assertTrue((trial < 0).any(), "a sample between trials counts for none")
                self.assertEqual((read[0], summary["sampled_read_mean_B_per_s"], summary["sampled_write_mean_B_per_s"]), (2.8e9, 2.8e9, 1.9e9))
                self.assertEqual((summary["sampled_fps_mean"], summary["sampled_gpu_clock_mean_Hz"]), (72, 545e6))
                start, end = f["timing/trial_start_unix_s"][0], f["timing/trial_end_unix_s"][2]
                for name in group:
                    t = group[name]["time_unix_s"][:]
                    self.assertTrue((t[1:] > t[:-1]).all() and t[0] > start - 5 and t[-1] < end + 5, name)
            os.rename(os.path.join(self.home, "world.json"), os.path.join(self.home, by + ".json"))
        with open(os.path.join(self.home, "perfetto.json"), encoding="utf-8") as text:
            self.assertEqual(json.load(text)["removed"], "/data/misc/perfetto-traces/clothbench.pftrace")

    def test_a_refused_trace_leaves_the_profiler_and_a_damaged_one_loses_only_counters(self):
        import h5py

        for plan, groups in (({"perfetto": "refused"}, {"vrapi", "ovrgpuprofiler"}), ({"perfetto": True, "trace_bytes": 1000}, {"vrapi"}),
                             ({"hzdb": "refused"}, {"vrapi", "ovrgpuprofiler"}), ({"hzdb": "lost"}, {"vrapi"}),
                             ({"perfetto": "old"}, {"vrapi", "ovrgpuprofiler"}), ({"perfetto": "lost", "trace_lost": True}, {"vrapi"})):
            self.out = os.path.join(self.home, "-".join(map(str, [*plan, *plan.values()])))
            self.run_app(**plan)
            self.assertRegex(self.text, "(?m)^PASS", "on a busy machine the simulated log may have gaps, so that trials are not valid")
            self.assertEqual("no counters" in self.text, groups == {"vrapi"}, self.text)
            with h5py.File(self.result()) as f:
                self.assertEqual(set(f["device_samples"]), groups)
            os.remove(os.path.join(self.home, "world.json"))

    def test_trials_of_fewer_than_five_samples_have_no_bandwidth(self):
        import h5py

        for count, expected in ((4, None), (5, 3.0)):
            raw, file = os.path.join(self.home, f"raw{count}"), os.path.join(self.home, "samples.json")
            subprocess.run([MAKE_SAMPLE, raw, "1.7e9"], check=True, stdout=subprocess.DEVNULL)
            # Complete samples of 0.05 s in the first trial, from 0.2 to 0.6 s, and one outside.
            times = [1.7e9 + 0.3 + 0.05 * k for k in range(count)] + [1.7e9 + 0.65]
            series = [{"name": role, "units": "1", "long_name": role, "role": role, "values": [3] * count + [9]} for role in ("read", "fps")]
            group = {"name": "g", "source": "s", "period_s": 0.05, "time_unix_s": times, "series": series}
            with open(file, "w", encoding="utf-8") as out:
                json.dump({"format": "clothbench-device-samples", "format_version": 2, "device": {}, "groups": [group]}, out)
            subprocess.run([CLOTHBENCH, "import", raw, "--samples", file], check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            with h5py.File(next(pathlib.Path(raw).glob("*.h5"))) as f:
                summary = {name: v for name, v in f["summary"].attrs.items() if v == v}
            self.assertEqual((summary.get("sampled_read_mean_B_per_s"), summary["sampled_fps_mean"]), (expected, 3.0))

    def test_the_import_says_what_is_wrong_with_samples(self):
        raw, file = os.path.join(self.home, "raw"), os.path.join(self.home, "samples.json")
        subprocess.run([MAKE_SAMPLE, raw, "1.7e9"], check=True, stdout=subprocess.DEVNULL)
        series = {"name": "a", "units": "1", "long_name": "a", "values": [1, None]}
        for pointer, top, group, column in (
            ("/format", {"format": "x"}, {}, {}),
            ("/groups/0/reasons", {}, {"reasons": [""]}, {}),
            ("/groups/0/name", {}, {"name": "a/b"}, {}),
            ("/groups/0/period_s", {}, {"period_s": 0}, {}),
            ("/groups/0/time_unix_s/1", {}, {"time_unix_s": [2, 1]}, {}),
            ("/groups/0/series/0/values", {}, {}, {"values": [1]}),
            ("/groups/0/series/0/values/0", {}, {}, {"values": ["1", 2]}),
            (None, {}, {}, {}),
        ):
            group = {"name": "g", "source": "s", "period_s": 1, "time_unix_s": [1, 2], "series": [{**series, **column}], **group}
            with open(file, "w", encoding="utf-8") as out:
                json.dump({"format": "clothbench-device-samples", "format_version": 2, "device": {}, "groups": [group], **top}, out)
            done = subprocess.run([CLOTHBENCH, "import", raw, "--samples", file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            self.assertEqual(done.returncode, 1 if pointer is None else 2, done.stdout)
            self.assertIn(f"samples.json: {pointer}: expected" if pointer else ".h5", done.stdout)

    def trials(self, **plan):
        """Runs the app; the reason against each of its three trials, "" if it is trusted."""
        self.code = self.run_app(**plan)
        self.assert_restored()
        path = self.result()
        report = os.path.join(self.home, "report")
        subprocess.run([CLOTHBENCH, "report", path, "-o", report], check=True, capture_output=True)
        with open(os.path.join(report, "report.md"), encoding="utf-8") as text:
            self.report = text.read()
        with open(os.path.join(report, "trials.csv"), encoding="utf-8") as text:
            return [row["not_trusted"] for row in csv.DictReader(text)]

    def test_only_the_trials_whose_clocks_moved_are_not_trusted(self):
        first, _, last = self.trials(moves_after_s=1.2)
        self.assertEqual((first, self.code), ("", 1), self.text)
        self.assertRegex(last, "gpu level 2, not 4")
        self.assertIn("NOT VALID: gpu level 2, not 4", self.text)
        self.assertRegex(self.report, r"\*\*Not a valid measurement: .*gpu level 2, not 4")

    def test_a_level_change_between_two_lines_is_not_trusted(self):
        trials = self.trials(announces_after_s=0.75)
        self.assertEqual((trials, self.code), (["", "levels changed 4,4 -> 4,2", ""], 1), self.text)

    def test_a_trial_whose_state_was_not_logged_is_not_trusted(self):
        trials = self.trials(log_ends_after_s=1.3, profiler=False)
        self.assertEqual((trials[0], trials[2]), ("", "the device did not log its state throughout"))

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
        self.assertEqual(self.drive("--serial", "C3", "restore", devices=two), 3, self.text)

    def test_levels_that_are_never_granted_are_refused(self):
        for cpu, words in (("4", "--gpu-level 5: the headset grants it only with dynamic resolution"), ("5", "CPU level 5 and GPU level 5 exclude each other")):
            self.assertEqual(self.run_app("--gpu-level", "5", "--cpu-level", cpu), 2, self.text)
            self.assertIn(words, self.text)
            self.assertFalse(os.path.exists(os.path.join(self.home, "world.json")), "no setting was changed")

    def test_what_ends_a_run_early(self):
        for words, plan, options in (
            ("No space left on device", {"pull_fails": True}, ()),
            ("SIGSEGV", {"crash_after_s": 0.6, "run_s": 1e9}, ()),
            ("the app did not start", {"start_fails": True}, ()),
            ("did not end within 1.5 s", {"run_s": 1e9}, ("--timeout-s", "1.5")),
            ("Failed to set property", {"refused_props": ["debug.oculus.refreshRate"]}, ()),
            ("FAIL: ", {"result": "FAIL"}, ()),
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
