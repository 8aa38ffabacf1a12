"""The parsers of scripts/quest/samples.py, on texts as the tools print them.

Origins: VrApi and XrPerformanceManager lines from Meta's page "Logcat stats definitions" (31 July 2025), with other
values; Perfetto's messages from the .proto files of google/perfetto, encoded here; ovrgpuprofiler from Meta's page "Use ovrgpuprofiler for GPU profiling"; the rest written by hand.
"""
import contextlib
import math
import os
import random
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
from quest import perfetto, samples  # noqa: E402

from protobuf import message  # noqa: E402

QUEST3 = ("FPS=72/72,Prd=38ms,Tear=0,Early=0,Stale=9,Stale2/5/10/max=4/3/2/11,VSnc=1,Lat=-1,Fov=0,CPU4/GPU=2/3,1171/441MHz,"
          "OC=FF,TA=0/0/0,SP=N/N/N,Mem=2092MHz,Free=2975MB,PLS=1,Temp=32.2C/0.0C,TW=1.25ms,App=4.49ms,GD=0.00ms,CPU&GPU=12.96ms,"
          "LCnt=2(DR72,LM2),GPU%=0.43,CPU%=0.37(W0.50),DSF=1.00,CFL=19.79/21.54,ICFLp95=20.94,LD=0,SF=0.85,LP=1,DVFS=0,ShrpLCnt=5,ShrpR=1.000,SSLCnt=3/3")


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
        self.assertEqual(samples.vrapi(QUEST3), {
            "fps": 72, "refresh_rate": 72, "cpu_level": 2, "gpu_level": 3, "cpu_clock_MHz": 1171, "gpu_clock_MHz": 441, "memory_clock_MHz": 2092,
            "power_level_state": 1, "battery_saver": 1, "voltage_scaling": 0, "temperature_C": 32.2, "stale_frames": 9, "stale_runs_of_2": 4,
            "stale_runs_of_5": 3, "stale_runs_of_10": 2, "stale_run_max": 11, "app_gpu_time_ms": 4.49, "gpu_utilization": 0.43,
            "compositor_latency_min_ms": 19.79, "compositor_latency_max_ms": 21.54, "compositor_latency_p95_ms": 20.94, "framebuffer_scale": 0.85})
        start = samples.vrapi("FPS=1/72,Prd=0ms,CPU4/GPU=4/4,1478/525MHz,App=-110.70ms,CFL=-1000.00/-1000.00")
        self.assertEqual((start["app_gpu_time_ms"], start["power_level_state"], start["battery_saver"], start["compositor_latency_max_ms"]), (-110.7, None, None, -1000))
        self.assertIsNone(samples.vrapi("VrApi::isWifiConnected exception"))

    def test_log_lines(self):
        self.assertEqual(samples.logcat("     1700000000.123  4242  4250 I VrApi   : FPS=72/72,x: y"), (1700000000.123, "VrApi", "FPS=72/72,x: y"))
        self.assertIsNone(samples.logcat("--------- beginning of main"))
        self.assertEqual(samples.level_change("perfmgr: SetClockLevels: Apply pending clock request change: 4,3 -> 3,3"), "4,3 -> 3,3")
        self.assertIsNone(samples.level_change('Max [level=4 reason="Set max GPU level for performance profile."]'))
        self.assertEqual([samples.result(f"RESULT {text}") for text in ("PASS", "FAIL ", "PASSED")], ["PASS", "FAIL", None])
        self.assertIsNone(samples.result("running study table3"))

    def test_numbers_and_names(self):
        self.assertEqual([samples.number(t) for t in ("1.5", "nan", "inf", "x", None)], [1.5, None, None, None, None])
        self.assertEqual([samples.dataset_name(n) for n in ("Read Total (Bytes/sec)", "GPU % Bus Busy")], ["Read_Total_Bytes_per_sec", "GPU_percent_Bus_Busy"])

    def test_groups_have_ascending_times_and_only_reported_series(self):
        rows = [(t, {**Validity.ROW, "fps": fps, "temperature_C": None}) for t, fps in ((2.0, 71.0), (1.0, 72.0), (2.0, 70.0))]
        (vrapi,) = samples.groups(rows, [], "perfetto", Validity.REQUESTED)
        self.assertEqual((vrapi["name"], vrapi["time_unix_s"], vrapi["period_s"], vrapi["reasons"]), ("vrapi", [1.0, 2.0], 1.0, ["", ""]))
        self.assertEqual([(s["name"], s["values"], s["role"]) for s in vrapi["series"] if s.get("role") in ("fps", "temperature")], [("fps", [72.0, 70.0], "fps")])


class Perfetto(unittest.TestCase):
    SPECS = message((1, message((1, 3), (2, b"Read Total (Bytes/sec)"), (3, b"description"), (7, 7), (8, 22))),
                    (1, message((1, 130), (2, b"GPU % Utilization"))), (3, 1_000_000))

    def trace(self):
        def clocks(*at):  # (clock, its time)
            return message((1, message((6, message(*((1, message((1, clock), (2, t))) for clock, t in at))))))

        def event(t, *counters, head=(), clock=()):
            values = [(2, message((1, at), (2 if isinstance(v, int) else 3, v))) for at, v in counters]
            return message((1, message((8, t), (52, message(*head, *values)), *((58, c) for c in clock))))

        return (clocks((6, 5_000_000_000), (1, 1_700_000_005_000_000_000), (3, 4_000_000_000))
                + message((1, message((8, 1), (58, 6), (11, b"another kind of packet"))))
                + event(6_000_000_000, head=[(1, self.SPECS)])  # the description only
                + event(6_010_000_000, (3, 2_800_000_000), (130, 41.5))
                + event(5_020_000_000, (3, -1), clock=[3])
                + clocks((6, 7_000_000_000), (64, 100))  # a clock of the GPU's own
                + event(30_000_100, (3, 7), clock=[64]))

    def test_samples_of_a_trace(self):
        read, utilization = "Read Total (Bytes/sec)", "GPU % Utilization"
        found = perfetto.samples(self.trace())
        self.assertEqual([values for _, values in found], [{read: 2_800_000_000, utilization: 41.5}, {read: -1}, {read: 7}])
        for (t, _), expected in zip(found, (1_700_000_006.01, 1_700_000_006.02, 1_700_000_007.03)):
            self.assertAlmostEqual(t, expected, delta=1e-5)

    def test_a_counter_source_is_found_by_its_prefix(self):
        ftrace, adreno = (message((2, message((1, message((1, name), *more)), (2, 1)))) for name, more in ((b"linux.ftrace", ()), (b"gpu.counters.adreno", ((5, self.SPECS),))))
        state = message((1, message((1, 1), (2, b"traced_probes")))) + ftrace + adreno
        self.assertEqual(perfetto.offered(state), ("gpu.counters.adreno", {"Read Total (Bytes/sec)": 3, "GPU % Utilization": 130}))
        self.assertEqual((perfetto.offered(ftrace), perfetto.offered(b"")), (("", {}), ("", {})))
        self.assertIn('name: "gpu.counters.adreno" gpu_counter_config { counter_period_ns: 10000000 counter_ids: 3 counter_ids: 130 }', perfetto.config("gpu.counters.adreno", [3, 130]))

    def test_damage_is_an_error_or_leaves_numbers(self):
        whole, random_bytes, refused = self.trace(), random.Random(7), 0
        for round_ in range(4000):
            damaged = bytearray(whole)
            for _ in range(1 + round_ % 3):
                damaged[random_bytes.randrange(len(damaged))] = random_bytes.randrange(256)
            try:
                found = perfetto.samples(bytes(damaged[:random_bytes.randrange(len(damaged))] if round_ % 2 else damaged))
            except ValueError:
                refused += 1
                continue
            self.assertTrue(all(math.isfinite(v) for t, values in found for v in (t, *values.values())))
        self.assertGreater(refused, 1000)
        state = message((2, message((1, message((1, b"gpu.counters.adreno"), (5, self.SPECS))), (2, 1))))
        lines = [QUEST3, "     1.5  1  2 I VrApi   : FPS=72/72", " 17 Clocks / Second : 4.2", "XrPerformanceManager: SetClockLevels: x: 4,4 -> 4,2"]
        for _ in range(4000):
            damaged = bytearray(state)
            damaged[random_bytes.randrange(len(damaged))] = random_bytes.randrange(256)
            with contextlib.suppress(ValueError):
                perfetto.offered(bytes(damaged))
            text = list(random_bytes.choice(lines))
            text[random_bytes.randrange(len(text))] = chr(random_bytes.randrange(32, 1000))
            text = "".join(text)
            (samples.logcat(text), samples.vrapi(text), samples.level_change(text), samples.counter_ids(text), samples.Counters().feed(0, text), samples.devices("\n" + text))


class Validity(unittest.TestCase):
    REQUESTED = {"cpu_level": 4, "gpu_level": 4, "refresh_rate": 72}
    ROW = {"refresh_rate": 72.0, "cpu_level": 4.0, "gpu_level": 4.0, "cpu_clock_MHz": 1920.0, "gpu_clock_MHz": 545.0, "power_level_state": 0.0,
           "battery_saver": 0.0, "changes": []}

    def doubts(self, **changed):
        """Eight lines, of which the last has other values."""
        rows = [(k, self.ROW) for k in range(7)] + [(7, {**self.ROW, **changed})]
        found = samples.doubts(rows, self.REQUESTED)
        self.assertEqual([found[k] for k in range(7)], [""] * 7)
        return found[7]

    def test_steady_is_valid(self):
        self.assertEqual(self.doubts(), "")
        self.assertEqual(self.doubts(battery_saver=None), "", "systems before 2023 do not print LP")

    def test_a_change_is_named(self):
        for name, other, text in (
            ("gpu_clock_MHz", 492, "gpu clock MHz 492, usually 545"),
            ("cpu_clock_MHz", 1650, "cpu clock MHz 1650, usually 1920"),
            ("gpu_level", 3, "gpu level 3, not 4"),
            ("refresh_rate", 36, "refresh rate 36, not 72"),
            ("power_level_state", 2, "power level state 2, not 0"),
            ("battery_saver", 1, "battery saver on"),
            ("changes", ["4,4 -> 4,3", "4,3 -> 4,4"], "levels changed 4,4 -> 4,3, levels changed 4,3 -> 4,4"),
        ):
            self.assertEqual(self.doubts(**{name: other}), text)

    def test_what_is_not_reported_is_not_trusted(self):
        for name in ("cpu_level", "gpu_level", "refresh_rate", "power_level_state"):
            self.assertIn("unknown, not", self.doubts(**{name: None}))


if __name__ == "__main__":
    unittest.main()
