"""The parsers of scripts/quest, on texts as the tools print them."""
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
from quest import formats, judge, samples  # noqa: E402


class Formats(unittest.TestCase):
    def test_metrics_are_found_by_name_whatever_their_numbers(self):
        ids = formats.metric_ids(
            formats.plain("47 metrics supported:\r\n1\tClocks / Second\r\n31\tRead Total (Bytes/sec)\r\n")
        )
        self.assertEqual(ids, {"Clocks / Second": 1, "Read Total (Bytes/sec)": 31})
        self.assertEqual(formats.metric_ids("ovrgpuprofiler: not found"), {})

    def test_blocks_end_at_an_empty_line_or_where_a_name_comes_again(self):
        blocks = formats.GpuBlocks()
        lines = [
            "Clocks / Second                            :   427468384.000\r\r",
            "% Vertex Fetch Stall   :   0.25",
            "",
            "Clocks / Second  :  1.000",
            "Clocks / Second  :  2.000",
            "",
            "",
            "unrelated",
        ]
        for k, line in enumerate(lines):
            blocks.feed(float(k), formats.plain(line))
        self.assertEqual(
            blocks.samples,
            [
                (2.0, {"Clocks / Second": 427468384.0, "% Vertex Fetch Stall": 0.25}),
                (4.0, {"Clocks / Second": 1.0}),
                (5.0, {"Clocks / Second": 2.0}),
            ],
        )

    def test_vrapi_of_two_headsets(self):
        quest3 = formats.vrapi(
            "FPS=72/72,Prd=38ms,Tear=0,Early=0,Stale=0,Stale2/5/10/max=0/0/0/0,VSnc=1,Lat=-1,Fov=0,CPU4/GPU=2/3,1171/441MHz,"
            "OC=FF,TA=0/0/0,SP=N/N/N,Mem=2092MHz,Free=2975MB,PLS=1,Temp=32.2C/0.0C,TW=1.25ms,App=4.49ms,GD=0.00ms"
        )
        self.assertEqual(
            [
                quest3[k]
                for k in (
                    "fps",
                    "refresh_rate",
                    "cpu_level",
                    "gpu_level",
                    "cpu_clock_MHz",
                    "gpu_clock_MHz",
                    "power_level_state",
                    "temperature_C",
                    "memory_clock_MHz",
                )
            ],
            [72, 72, 2, 3, 1171, 441, 1, 32.2, 2092],
        )
        start = formats.vrapi("FPS=1/72,Prd=0ms,CPU4/GPU=4/4,1478/525MHz,App=-110.70ms")
        self.assertEqual((start["app_gpu_time_ms"], start["power_level_state"]), (-110.7, None))
        self.assertIsNone(formats.vrapi("VrApi::isWifiConnected exception"))

    def test_log_lines(self):
        self.assertEqual(
            formats.logcat("     1700000000.123  4242  4250 I VrApi   : FPS=72/72,x: y"),
            (1700000000.123, "VrApi", "FPS=72/72,x: y"),
        )
        self.assertIsNone(formats.logcat("--------- beginning of main"))
        self.assertEqual(formats.result("RESULT PASS /sdcard/a b"), (True, "/sdcard/a b"))
        self.assertIsNone(formats.result("running study table3: results in /sdcard"))

    def test_ovr_metrics_by_header_with_extra_fields_crlf_and_a_torn_row(self):
        text = "Time Stamp,gpu_level,new_column,average_frame_rate\r\n1000,4,,72\r\n2000,4,,71.5,a text of the app\r\n3000,4\r\n"
        times, columns, left_out = formats.ovr_csv(text)
        self.assertEqual(
            (times, columns, left_out), ([1.0, 2.0], {"gpu_level": [4.0, 4.0], "average_frame_rate": [72.0, 71.5]}, 1)
        )
        self.assertEqual(formats.ovr_csv("no header\n1,2\n"), ([], {}, 2))
        self.assertEqual(formats.ovr_csv(""), ([], {}, 0))

    def test_battery_heat_and_storage(self):
        self.assertEqual(
            formats.battery(
                "  AC powered: false\r\n  USB powered: true\r\n  level: 84\r\n  temperature: 312\r\n".replace("\r", "")
            ),
            {"level": 84, "temperature_C": 31.2, "powered": True},
        )
        self.assertEqual(formats.battery("Can't find service"), {"level": None, "temperature_C": None, "powered": None})
        self.assertEqual(formats.thermal_status("IsStatusOverride: false\nThermal Status: 3\n"), 3)
        self.assertEqual(
            formats.free_B("Filesystem 1K-blocks Used Available Use% Mounted on\n/dev/fuse 10 3 7 9% /storage"),
            7 * 1024,
        )
        self.assertIsNone(formats.free_B("df: /sdcard: No such file"))

    def test_names_of_datasets(self):
        self.assertEqual(formats.slug("Read Total (Bytes/sec)"), "Read_Total_Bytes_per_sec")
        self.assertEqual(formats.slug("GPU % Bus Busy"), "GPU_percent_Bus_Busy")


class Judge(unittest.TestCase):
    ASKED = {"cpu_level": 4, "gpu_level": 4, "refresh_hz": 72}
    LINE = {
        "refresh_rate": 72.0,
        "cpu_level": 4.0,
        "gpu_level": 4.0,
        "cpu_clock_MHz": 1920.0,
        "gpu_clock_MHz": 545.0,
        "power_level_state": 0.0,
    }

    def reasons(self, seconds, since=3, **changed):
        rows = [(k, dict(self.LINE, **{name: v[k] for name, v in changed.items()})) for k in range(seconds)]
        return judge.judge([samples.vrapi_group(rows)], self.ASKED, since, seconds, [])

    def test_steady_is_valid(self):
        self.assertEqual(self.reasons(8), [])

    def test_what_moves_is_named_but_not_before_it_settled(self):
        for name, usual, other, word in (
            ("gpu_clock_MHz", 545, 492, "GPU clock"),
            ("cpu_clock_MHz", 1920, 1650, "CPU clock"),
            ("gpu_level", 4, 3, "GPU level"),
            ("refresh_rate", 72, 90, "refresh rate"),
            ("power_level_state", 0, 2, "power level state"),
        ):
            late, early = [usual] * 7 + [other], [other] + [usual] * 7
            self.assertTrue(any(word in r for r in self.reasons(8, **{name: late})), name)
            self.assertEqual(self.reasons(8, **{name: early}), [], name)

    def test_nothing_told_is_not_valid(self):
        self.assertEqual(len(judge.judge([], self.ASKED, 0, 9, [])), 3)

    def test_a_level_that_was_not_granted(self):
        self.assertTrue(any("4 was asked for" in r for r in self.reasons(8, gpu_level=[2] * 8)))


if __name__ == "__main__":
    unittest.main()
