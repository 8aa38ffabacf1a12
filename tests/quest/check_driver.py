"""usage: check_driver.py CLOTHBENCH MAKE_SAMPLE: scripts/quest_run.py with fake_adb.py for a headset; what goes wrong with
headsets goes wrong here, and whatever happens the headset ends as it was."""
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
BEFORE = {
    "debug.oculus.cpuLevel": "",
    "debug.oculus.gpuLevel": "2",
    "debug.oculus.refreshRate": "90",
    "debug.oculus.clockStateLogLevel": "",
}
PINNED = {
    "debug.oculus.cpuLevel": "4",
    "debug.oculus.gpuLevel": "4",
    "debug.oculus.refreshRate": "72",
    "debug.oculus.clockStateLogLevel": "1",
}


class Driver(unittest.TestCase):
    def setUp(self):
        self.home = tempfile.mkdtemp(prefix="clothbench-quest-")
        self.addCleanup(shutil.rmtree, self.home, ignore_errors=True)
        self.out = os.path.join(self.home, "out")
        os.mkdir(os.path.join(self.home, "bin"))
        os.symlink(os.path.join(HERE, "fake_adb.py"), os.path.join(self.home, "bin", "adb"))

    def start(self, *words, **plan):
        plan = dict(
            {
                "props": BEFORE,
                "make_sample": MAKE_SAMPLE,
                "run_s": 2.2,
                "runs": "/sdcard/Android/data/org.clothbench.quest/files/runs/table3-20260101T000000Z",
            },
            **plan,
        )
        with open(os.path.join(self.home, "plan.json"), "w", encoding="utf-8") as out:
            json.dump(plan, out)
        env = dict(os.environ, FAKE_ADB=self.home, PATH=os.path.join(self.home, "bin") + ":" + os.environ["PATH"])
        options = [
            "--poll-s",
            "0.2",
            "--settle-s",
            "0.2",
            "--wait-s",
            "4",
            "--timeout-s",
            "60",
            "--state",
            os.path.join(self.home, "state"),
            "--clothbench",
            CLOTHBENCH,
        ]
        if "--restore" not in words:
            options += ["--out", self.out]
        return subprocess.Popen(
            [sys.executable, "-S", DRIVER, *options, *words],
            env=env,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def drive(self, *words, **plan):
        process = self.start(*words, **plan)
        self.text, _ = process.communicate(timeout=120)
        return process.returncode

    def world(self):
        with open(os.path.join(self.home, "world.json"), encoding="utf-8") as text:
            return json.load(text)

    def calls(self):
        with open(os.path.join(self.home, "calls.log"), encoding="utf-8") as text:
            return [json.loads(line)[-1] for line in text]

    def left_running(self):
        """Processes of this test's adb."""
        left = []
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{pid}/environ", "rb") as env:
                    if f"FAKE_ADB={self.home}".encode() in env.read().split(b"\0"):
                        left.append(pid)
            except OSError:
                continue
        return left

    def assert_restored(self):
        world = self.world()
        self.assertEqual(world["props"], BEFORE, self.text)
        self.assertFalse(world["worn"])
        self.assertIsNotNone(world["csv_end"], "OVR Metrics was switched off")
        self.assertEqual(os.listdir(os.path.join(self.home, "state")), [])
        self.assertEqual(self.left_running(), [])

    def samples(self):
        with open(os.path.join(self.out, "samples.json"), encoding="utf-8") as text:
            return json.load(text)

    def assert_touched_nothing(self):
        # `am force-stop` of a run that ended is the only thing allowed.
        self.assertFalse([c for c in self.calls() if c.startswith(("setprop", "am start", "am broadcast"))], self.text)

    # --- what should work

    def test_a_run_from_end_to_end(self):
        import h5py

        code = self.drive("study table3 --set 'a b'", clock_ahead_s=3.5, line_end="\r\n")
        self.assertEqual(code, 0, self.text)
        self.assertIn("passed", self.text)
        self.assert_restored()
        self.assertEqual(
            self.world()["extra"], "'study table3 --set '\"'\"'a b'\"'\"''", "the device's shell hands on one argument"
        )
        sets = [c for c in self.calls() if c.startswith("setprop")]
        self.assertEqual([c.split()[1:] for c in sets[:4]], [[k, v] for k, v in PINNED.items()])
        found = self.samples()
        self.assertEqual((found["valid"], found["reasons"]), (True, []))
        self.assertEqual([g["name"] for g in found["groups"]], ["vrapi", "ovrgpuprofiler", "battery", "ovr_metrics"])
        path = os.path.join(self.out, "runs", "table3-20260101T000000Z", "sample__none__readback=blocking.h5")
        with h5py.File(path) as f:
            group = f["device_samples"]
            self.assertEqual((group.attrs["valid"], group.attrs["reasons"]), (1, ""))
            profiler, summary = group["ovrgpuprofiler"], f["summary"].attrs
            self.assertAlmostEqual(float(profiler.attrs["period_s"]), 0.1, delta=0.06)
            read, trial = profiler["Read_Total_Bytes_per_sec"][:], profiler["trial"][:]
            self.assertEqual(profiler["Read_Total_Bytes_per_sec"].attrs["units"], "B s-1")
            inside = read[trial >= 0]
            self.assertGreater(len(inside), 2, "trials of 0.4 s hold samples of 0.1 s")
            self.assertTrue((trial < 0).any(), "between the trials none counts")
            self.assertAlmostEqual(summary["sampled_read_mean_B_per_s"], inside.mean())
            self.assertEqual(summary["sampled_read_peak_B_per_s"], inside.max())
            self.assertEqual(profiler["Read_Total_Bytes_per_sec_window_max"][:].max(), inside.max())
            self.assertEqual(summary["sampled_write_mean_B_per_s"], 1.9e9)
            self.assertEqual((summary["sampled_fps_mean"], summary["sampled_gpu_clock_mean_Hz"]), (72, 545e6))
            start, end = f["timing/trial_start_unix_s"][0], f["timing/trial_end_unix_s"][2]
            self.assertLess(abs(start - time.time() - 3.5), 60)
            for name in group:
                t = group[name]["time_unix_s"][:]
                self.assertTrue((t[1:] > t[:-1]).all() and t[0] > start - 5 and t[-1] < end + 5, name)
            self.assertTrue((group["ovr_metrics/gpu_frequency_MHz"][:] == 545).all())
        report = os.path.join(self.home, "report")
        subprocess.run(
            [CLOTHBENCH, "report", path, "-o", report], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        with open(os.path.join(report, "report.md"), encoding="utf-8") as text:
            markdown = text.read()
        self.assertIn("The device's own counters during the trials", markdown)
        self.assertNotIn("Not a valid measurement", markdown)

    def test_the_import_says_what_is_wrong_with_samples(self):
        raw, file = os.path.join(self.home, "raw"), os.path.join(self.home, "samples.json")
        subprocess.run([MAKE_SAMPLE, raw, "1.7e9"], check=True, stdout=subprocess.DEVNULL)
        good = {
            "format": "clothbench-device-samples",
            "format_version": 1,
            "valid": True,
            "reasons": [],
            "device": {},
            "groups": [
                {
                    "name": "g",
                    "source": "s",
                    "period_s": 1,
                    "time_unix_s": [1, 2],
                    "series": [{"name": "a", "units": "1", "long_name": "a", "values": [1, None]}],
                }
            ],
        }
        for pointer, change in (
            ("/format", lambda j: j.update(format="x")),
            ("/valid", lambda j: j.update(valid=False)),
            ("/groups/0/name", lambda j: j["groups"][0].update(name="a/b")),
            ("/groups/0/period_s", lambda j: j["groups"][0].update(period_s=0)),
            ("/groups/0/time_unix_s/1", lambda j: j["groups"][0].update(time_unix_s=[2, 1])),
            ("/groups/0/series/0/values", lambda j: j["groups"][0]["series"][0].update(values=[1])),
            ("/groups/0/series/0/values/0", lambda j: j["groups"][0]["series"][0].update(values=["1", 2])),
            (None, lambda j: None),
        ):
            changed = json.loads(json.dumps(good))
            change(changed)
            with open(file, "w", encoding="utf-8") as out:
                json.dump(changed, out)
            done = subprocess.run(
                [CLOTHBENCH, "import", raw, "--samples", file],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                check=False,
            )
            self.assertEqual(done.returncode, 0 if pointer is None else 2, done.stdout)
            self.assertIn(f"samples.json: {pointer}: expected" if pointer else ".h5", done.stdout)

    def test_clocks_that_moved_are_seen_in_the_report(self):
        code = self.drive(moves_after_s=1.0, moves_to={"gpu": 2, "mhz": 456})
        self.assertEqual(code, 1, self.text)
        self.assert_restored()
        self.assertIn("NOT VALID: GPU clock [MHz] moved: 456 to 545 (vrapi)", self.text)
        report = os.path.join(self.home, "report")
        path = os.path.join(self.out, "runs", "table3-20260101T000000Z", "sample__none__readback=blocking.h5")
        subprocess.run(
            [CLOTHBENCH, "report", path, "-o", report], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        with open(os.path.join(report, "report.md"), encoding="utf-8") as text:
            self.assertIn("**Not a valid measurement: GPU clock [MHz] moved: 456 to 545 (vrapi).**", text.read())

    def test_heat_and_refresh_rate_that_moved(self):
        self.assertEqual(self.drive(moves_after_s=0.8, moves_to={"pls": 1, "hz": 90, "tenths": 412}), 1, self.text)
        self.assert_restored()
        for word in ("power level state", "refresh rate", "temperature moved"):
            self.assertIn(word, self.text)

    # --- what is missing

    def test_missing_metrics(self):
        code = self.drive(missing_metrics=["Read Total (Bytes/sec)", "Write Total (Bytes/sec)"], metrics_tool=False)
        self.assertEqual(code, 0, self.text)
        self.assert_restored()
        self.assertIn("no 'Read Total (Bytes/sec)' here", self.text)
        self.assertIn("bus was busy stands in", self.text)
        names = [s["name"] for g in self.samples()["groups"] if g["name"] == "ovrgpuprofiler" for s in g["series"]]
        self.assertEqual(
            sorted(names), ["Clocks_per_Second", "GPU_percent_Bus_Busy", "percent_Stalled_on_System_Memory"]
        )

    def test_no_profiler_and_no_log_of_clocks(self):
        self.assertEqual(self.drive(profiler=False, vrapi=False, metrics_tool=False), 1, self.text)
        self.assert_restored()
        self.assertIn("GPU level: not reported by the device", self.text)

    # --- what ends a run before it begins

    def test_no_device(self):
        self.assertEqual(self.drive(devices=[]), 3, self.text)
        self.assertIn("adb finds no device", self.text)
        self.assertEqual(self.drive(devices=[["A1", "unauthorized", "x"]]), 3)
        self.assertIn("allow USB debugging", self.text)

    def test_two_devices(self):
        two = [["A1", "device", "Quest_3"], ["B2", "device", "Quest_3S"]]
        self.assertEqual(self.drive(devices=two), 2, self.text)
        self.assertIn("--serial: A1 (Quest 3), B2 (Quest 3S)", self.text)
        self.assertEqual(self.drive("--serial", "C3", devices=two), 3)
        self.assertEqual(self.drive("--serial", "B2", devices=two), 0, self.text)
        self.assert_restored()

    def test_a_headset_that_would_not_measure_well(self):
        for code, word, plan in (
            (2, "Quest 2", {"model": "Quest 2"}),
            (1, "battery at 12.0 %", {"level": 12}),
            (1, "41.3 °C", {"tenths": 413}),
            (1, "thermal status 2", {"thermal": 2}),
            (2, "not installed", {"installed": False}),
            (1, "storage is full: 10 MB free", {"free_kB": 10000}),
        ):
            self.assertEqual(self.drive(**plan), code, self.text)
            self.assertIn(word, self.text)
            self.assert_touched_nothing()

    # --- what goes wrong on the way

    def test_full_storage(self):
        self.assertEqual(self.drive("--apk", __file__, install_fails=True), 1)
        self.assertIn("INSUFFICIENT_STORAGE", self.text)
        self.assert_touched_nothing()
        self.assertEqual(self.drive(pull_fails="runs/table3"), 1, self.text)
        self.assertIn("No space left on device", self.text)
        self.assert_restored()
        self.assertTrue(self.samples()["groups"], "what was sampled is kept")

    def test_the_app_crashes(self):
        self.assertEqual(self.drive(crash_after_s=0.6), 1)
        self.assertIn("it crashed or was closed", self.text)
        self.assertIn("SIGSEGV", self.text)
        self.assert_restored()

    def test_the_app_does_not_start_fails_or_hangs(self):
        self.assertEqual(self.drive(start_fails=True), 1)
        self.assertIn("did not start", self.text)
        self.assert_restored()
        self.assertEqual(self.drive("--timeout-s", "1.5", run_s=1e9), 1, self.text)
        self.assertIn("did not end within 1.5 s", self.text)
        self.assert_restored()

    def test_a_failed_run_is_fetched_too(self):
        self.assertEqual(self.drive(result="FAIL", session=False), 1)
        self.assertIn("FAILED", self.text)
        self.assertTrue(os.path.isdir(os.path.join(self.out, "runs", "table3-20260101T000000Z")))
        self.assert_restored()

    def test_unplugged_for_a_while(self):
        self.assertEqual(self.drive(unplugged=[0.6, 1.6], run_s=3.5), 1, self.text)
        self.assertIn("the app continues without the cable", self.text)
        self.assertIn("NOT VALID: the headset did not answer for", self.text)
        self.assertTrue(
            os.path.isdir(os.path.join(self.out, "runs", "table3-20260101T000000Z")), "the result was not missed"
        )
        self.assert_restored()

    def test_unplugged_for_good_and_put_right_later(self):
        plan = {"unplugged": [0.6, None]}
        self.assertEqual(self.drive("--wait-s", "1", **plan), 3, self.text)
        self.assertIn("quest_run.py --restore", self.text)
        self.assertEqual(self.world()["props"], PINNED)
        self.assertEqual(len(os.listdir(os.path.join(self.home, "state"))), 1)
        open(os.path.join(self.home, "plugged-in"), "w").close()
        self.assertEqual(self.drive("--restore", **plan), 0, self.text)
        self.assert_restored()

    def test_killed_and_put_right_by_the_next_run(self):
        process = self.start(run_s=1e9)
        self.wait_for_app()
        process.kill()
        process.communicate()
        self.assertEqual(self.world()["props"], PINNED)
        for pid in self.left_running():
            os.kill(int(pid), signal.SIGKILL)
        shutil.rmtree(self.out)
        self.assertEqual(self.drive(), 0, self.text)
        self.assertIn("as it was before a run that was cut off", self.text)
        self.assert_restored()

    def wait_for_app(self):
        for _ in range(600):
            if os.path.exists(os.path.join(self.home, "world.json")) and self.world()["started"]:
                return
            time.sleep(0.05)
        self.fail("the app was never started")

    def test_interrupted(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start(run_s=1e9)
            self.wait_for_app()
            time.sleep(0.3)
            process.send_signal(number)
            time.sleep(0.2)
            process.send_signal(number)  # an impatient user
            self.text, _ = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 130, self.text)
            self.assert_restored()
            self.assertIsNotNone(self.world()["stopped"], "the app was stopped")
            shutil.rmtree(self.out)
            os.remove(os.path.join(self.home, "world.json"))

    def test_a_setting_the_headset_refuses(self):
        self.assertEqual(self.drive(stubborn_props=["debug.oculus.refreshRate"]), 1)
        self.assertIn("Failed to set property", self.text)
        world = self.world()
        self.assertIsNone(world["started"])
        self.assertEqual(world["props"], BEFORE)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
