"""usage: check_interface.py CLOTHBENCH EXAMPLE LIBRARIES SOURCE: a plugin that uses the whole interface."""
import json
import os
import pathlib
import shutil

import h5py

from command import PluginTest, main

SMALL = ["--set", "cloth.grid=[8,8]", "--set", "cloth.sides=single"]


class Interface(PluginTest):
    def library(self, name="full_NONE"):
        return super().library(name)

    def run_on(self, scene, *more, trials=1, code=0, **environment):
        words = ["run", scene, "--solver", self.library(), "--trials", str(trials), "--out", self.out, *more]
        self.assertEqual(self.command(*words, **environment), code, self.text)

    def stored(self, name):
        return h5py.File(os.path.join(self.out, name + ".h5"))

    def noted(self):
        return pathlib.Path(self.log).read_text(encoding="utf-8") if os.path.exists(self.log) else ""

    def test_the_rest_shape_and_springs_of_grids_and_meshes(self):
        # The plugin checks its input and refuses creation if it is wrong.
        for scene, *more in (
            ("paper/gravity", *SMALL),
            ("paper/gravity", *SMALL, "--set", "material.membrane_stiffness_N_per_m=50"),
            ("validation/capstan-hold",),  # draped
            ("validation/hang-elastic",),  # strips, without shear
            ("validation/hang-mesh",),
            ("stability/s13-sliver",),  # uneven cells
            ("stability/s15-crumpled",),
            ("stability/s18-soup",),
        ):
            shutil.rmtree(self.out, ignore_errors=True)
            with self.subTest(scene=scene):
                self.run_on(scene, *more, trials=0)
                (file,) = pathlib.Path(self.out).glob("*.h5")
                with h5py.File(file) as f:
                    self.assertNotEqual(f["outcome"].attrs["status"], "error", dict(f["outcome"].attrs))

    def test_the_device_and_its_times_are_stored(self):
        self.run_on("paper/gravity", *SMALL)
        with self.stored("gravity__full__default") as f:
            self.assertEqual(f["outcome"].attrs["status"], "ok", dict(f["outcome"].attrs))
            header = json.loads(f["header_json"][0])
            environment = header["environment"]
            said = [environment[k] for k in ("gpu", "driver", "api", "gpu_is_software")]
            self.assertEqual(said, ["Paper GPU", "driver 7", "CUDA 1.0", True])
            self.assertEqual(environment["gpu_properties"], {"cores": 3})
            self.assertEqual(environment["plugin"]["engine"], "Engine")
            self.assertNotIn("frame_cpu_s", f["timing"], "a solver on a GPU")
            self.assertTrue((f["timing/frame_device_s"][...] == 1e-4).all())

    def test_its_counts_are_series(self):
        self.run_on("paper/gravity", *SMALL, trials=0)
        with self.stored("gravity__full__default") as f:
            steps = f["metrics/solver_steps"]
            self.assertEqual(list(steps[...]), list(range(len(f["metrics/time_s"]))))
            self.assertEqual(steps.attrs["long_name"], "steps so far")
            self.assertFalse(f["metrics/solver_never"][...].any())

    def test_a_scene_that_it_cannot_run_is_unsupported_because_it_says_so(self):
        self.run_on("paper/gravity", "--set", "cloth.grid=[13,8]", "--set", "cloth.sides=single")
        with self.stored("gravity__full__default") as f:
            self.assertEqual(f["outcome"].attrs["status"], "unsupported")
            self.assertEqual(f["outcome"].attrs["message"], "full: 13 columns are too many")
        self.assertEqual(self.command("plan", "paper/gravity", "--solver", self.library(), FAULT="refuse"), 0, self.text)
        self.assertIn("unsupported", self.text)
        self.assertIn("it was asked to refuse", self.text)

    def test_frames_begin_where_the_last_ended_and_jumps_are_marked(self):
        self.run_on("stability/s17-collider-teleport", trials=0)
        (file,) = pathlib.Path(self.out).glob("*.h5")
        with h5py.File(file) as f:
            self.assertNotEqual(f["outcome"].attrs["status"], "error", dict(f["outcome"].attrs))
            self.assertNotIn("without a solution", f["outcome"].attrs["message"])
        self.assertRegex(self.noted(), r"teleport frame=\d+ collider=0")
        os.remove(self.log)
        shutil.rmtree(self.out)
        self.run_on("stability/s08-jerk", trials=0)
        self.assertRegex(self.noted(), r"teleport frame=\d+ grip=\d+")
        self.assertNotIn("collider", self.noted())

    def test_a_restart_comes_with_its_moment(self):
        self.assertIn(self.command("conformance", self.library(), "--scene", "conformance/sheet", "--no-whole"), (0, 1), self.text)
        self.assertRegex(self.noted(), r"restart index=[1-9]\d* time=0\.[0-9]+")

    def test_conformance_checks_counts(self):
        self.command("conformance", self.library(), "--scene", "conformance/sheet", "--no-whole", FAULT="count_missing")
        self.assertIn("counts: expected the same names after every frame", self.text)

    def test_another_size_is_refused(self):
        self.assertEqual(self.command("run", "paper/gravity", "--solver", self.library("full_TOO_SMALL"), "--out", self.out), 2, self.text)
        self.assertIn("its ClothbenchPlugin has", self.text)

    def test_faulty_values_are_told(self):
        for fault, message in (
            ("unsupported", "unsupported: expected a reason or NULL; found an empty text"),
            ("driver", "device_info: driver: expected a text"),
            ("properties", "device_info: properties_json: expected a JSON object; found [3]"),
            ("device_time", "device_s: expected a time of 0 s or more, or NAN; found -1"),
            ("count_name", 'counts: expected a name of small letters, digits, _; found "Steps"'),
            ("count_value", "counts: never: expected a text and a finite value"),
            ("count_missing", "counts: expected the same names after every frame"),
        ):
            shutil.rmtree(self.out, ignore_errors=True)
            with self.subTest(fault=fault):
                self.run_on("paper/gravity", *SMALL, code=1, FAULT=fault)
                with self.stored("gravity__full__default") as f:
                    self.assertEqual(f["outcome"].attrs["status"], "error")
                    self.assertIn(message, f["outcome"].attrs["message"])


if __name__ == "__main__":
    main()
