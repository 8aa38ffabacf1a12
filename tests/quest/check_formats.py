"""The parsers of scripts/quest/samples.py, on texts as the tools print them."""
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
from quest import samples  # noqa: E402

QUEST3 = ("FPS=72/72,Prd=38ms,Tear=0,Early=0,Stale=0,Stale2/5/10/max=0/0/0/0,VSnc=1,Lat=-1,Fov=0,CPU4/GPU=2/3,1171/441MHz,"
          "OC=FF,TA=0/0/0,SP=N/N/N,Mem=2092MHz,Free=2975MB,PLS=1,Temp=32.2C/0.0C,TW=1.25ms,App=4.49ms,GD=0.00ms")


class Formats(unittest.TestCase):
    def test_devices(self):
        self.assertEqual(samples.devices("List of devices attached\n1W device usb:1-2 model:Quest_3\n* daemon started\n2X unauthorized\n\n"), [("1W", "device"), ("2X", "unauthorized")])

    def test_counters_are_found_by_name(self):
        self.assertEqual(samples.counter_ids("47 metrics supported:\n1\tClocks / Second\n31\tRead Total (Bytes/sec)\n"), {"Clocks / Second": 1, "Read Total (Bytes/sec)": 31})
        self.assertEqual(samples.counter_ids("ovrgpuprofiler: not found"), {})

    def test_a_block_ends_at_an_empty_line_or_where_a_name_repeats(self):
        counters = samples.Counters()
        for k, line in enumerate(["Clocks / Second                            :   427468384.000", "% Vertex Fetch Stall   :   0.25", "",
                                  "Clocks / Second  :  1.000", "Clocks / Second  :  2.000", "", "", "unrelated"]):
            counters.feed(float(k), line)
        self.assertEqual(counters.samples, [(2.0, {"Clocks / Second": 427468384.0, "% Vertex Fetch Stall": 0.25}), (4.0, {"Clocks / Second": 1.0}), (5.0, {"Clocks / Second": 2.0})])

    def test_vrapi(self):
        names = ("fps", "refresh_rate", "cpu_level", "gpu_level", "cpu_clock_MHz", "gpu_clock_MHz", "power_level_state", "temperature_C", "memory_clock_MHz", "app_gpu_time_ms")
        self.assertEqual([samples.vrapi(QUEST3)[k] for k in names], [72, 72, 2, 3, 1171, 441, 1, 32.2, 2092, 4.49])
        start = samples.vrapi("FPS=1/72,Prd=0ms,CPU4/GPU=4/4,1478/525MHz,App=-110.70ms")
        self.assertEqual((start["app_gpu_time_ms"], start["power_level_state"]), (-110.7, None))
        self.assertIsNone(samples.vrapi("VrApi::isWifiConnected exception"))

    def test_log_lines(self):
        self.assertEqual(samples.logcat("     1700000000.123  4242  4250 I VrApi   : FPS=72/72,x: y"), (1700000000.123, "VrApi", "FPS=72/72,x: y"))
        self.assertIsNone(samples.logcat("--------- beginning of main"))
        self.assertEqual(samples.result("RESULT PASS /sdcard/a b"), (True, "/sdcard/a b"))
        self.assertEqual(samples.result("RESULT FAIL /sdcard/a"), (False, "/sdcard/a"))
        self.assertIsNone(samples.result("running study table3: results in /sdcard"))

    def test_numbers_and_names(self):
        self.assertEqual([samples.number(t) for t in ("1.5", "nan", "inf", "x", None)], [1.5, None, None, None, None])
        self.assertEqual([samples.dataset_name(n) for n in ("Read Total (Bytes/sec)", "GPU % Bus Busy")], ["Read_Total_Bytes_per_sec", "GPU_percent_Bus_Busy"])

    def test_groups_have_ascending_times_and_only_reported_series(self):
        rows = [(2.0, {"fps": 71.0, "gpu_level": None}), (1.0, {"fps": 72.0, "gpu_level": None}), (2.0, {"fps": 70.0, "gpu_level": None})]
        (vrapi,) = samples.groups(rows, [])
        self.assertEqual((vrapi["name"], vrapi["time_unix_s"], vrapi["period_s"]), ("vrapi", [1.0, 2.0], 1.0))
        self.assertEqual([(s["name"], s["values"], s["role"]) for s in vrapi["series"]], [("fps", [72.0, 70.0], "fps")])


class Validity(unittest.TestCase):
    REQUESTED = {"cpu_level": 4, "gpu_level": 4, "refresh_rate": 72}
    ROW = {"refresh_rate": 72.0, "cpu_level": 4.0, "gpu_level": 4.0, "cpu_clock_MHz": 1920.0, "gpu_clock_MHz": 545.0, "power_level_state": 0.0}

    def reasons(self, **changed):
        rows = [(k, {**self.ROW, **{name: v[k] for name, v in changed.items()}}) for k in range(8)]
        return samples.reasons_against(rows, self.REQUESTED, 3, 8)

    def test_steady_is_valid(self):
        self.assertEqual(self.reasons(), [])

    def test_a_change_is_named_once_clocks_have_settled(self):
        for name, usual, other in (("gpu_clock_MHz", 545, 492), ("cpu_clock_MHz", 1920, 1650), ("gpu_level", 4, 3), ("refresh_rate", 72, 90), ("power_level_state", 0, 2)):
            late, early = self.reasons(**{name: [usual] * 7 + [other]}), self.reasons(**{name: [other] + [usual] * 7})
            self.assertEqual((len(late), early), (1, []))
            self.assertTrue(late[0].startswith(name.replace("_", " ")), late)

    def test_a_level_that_was_not_granted_or_not_reported(self):
        self.assertEqual(self.reasons(gpu_level=[2] * 8), ["gpu level: 2; 4 was requested"])
        self.assertEqual(len(samples.reasons_against([], self.REQUESTED, 0, 9)), 4)


if __name__ == "__main__":
    unittest.main()
