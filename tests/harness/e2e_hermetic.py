#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The user's environment does not change a frame: frames are bit-identical with hostile settings of
POV-Ray, Blender, Python, OpenColorIO, Mesa and Vulkan and without any."""
import os
import pathlib
import unittest

import frames
import neph_case

CLEAN = {name: os.environ[name] for name in ("PATH", "NEPH_DATA_DIR", "MESA_SHADER_CACHE_DIR")
         if name in os.environ}

# A quarter of the frame, black elsewhere; neph's command line does not set these options.
POVRAY_INI = "Start_Column=5\nEnd_Row=4\nLibrary_Path=/nonexistent\n"
# Runs when Blender or Python starts, and changes the exposure of a later render.
BLENDER_SCRIPT = """
import pathlib
pathlib.Path({trace!r}).open("a").write(__file__ + chr(10))
try:
    import bpy
    def register():
        bpy.app.handlers.render_init.append(
            lambda scene, *_: setattr(scene.cycles, "film_exposure", 0.25))
    def unregister(): pass
except ImportError:
    pass
"""


class Hermetic(neph_case.NephCase):
    surroundings = CLEAN
    in_folder = True

    def setUp(self):
        super().setUp()
        self.trace = self.folder / "trace"

    def hostile(self):
        """An environment in which every setting is changed; the working folder has settings as
        well."""
        home = self.folder / "home"
        script = BLENDER_SCRIPT.format(trace=str(self.trace))
        for ini in ("home/.povray/3.7/povray.ini", "home/.povrayrc", "povini.ini", "povray.ini"):
            self.put(ini, POVRAY_INI)
        for start in ("home/.config/blender/3.4/scripts/startup", "scripts/startup",
                      "config/blender/3.4/scripts/startup"):
            self.put(f"{start}/evil.py", script)
        self.put("python/sitecustomize.py", script)
        self.put("home/.local/share/vulkan/implicit_layer.d/evil.json", '{"file_format_version": '
                 '"1.0.0", "layer": {"name": "VK_LAYER_evil", "type": "GLOBAL", "library_path": '
                 '"/nonexistent.so", "api_version": "1.3.0", "implementation_version": "1", '
                 '"description": "evil", ' '"disable_environment": {"NO_EVIL": "1"}}}')
        # A new cache for Mesa: it has no shader compiled without these settings.
        return {**CLEAN, "MESA_SHADER_CACHE_DIR": str(home / "mesa"), "HOME": str(home),
                "POVINI": str(self.folder / "povini.ini"), "POVINC": "/nonexistent",
                "XDG_CONFIG_HOME": str(self.folder / "config"),
                "BLENDER_USER_SCRIPTS": str(self.folder / "scripts"),
                "BLENDER_SYSTEM_SCRIPTS": "/nonexistent", "BLENDER_USER_CONFIG": "/nonexistent",
                "PYTHONPATH": str(self.folder / "python"), "PYTHONHOME": "/nonexistent",
                "PYTHONSTARTUP": "/nonexistent", "CYCLES_CPU_NO_AVX2": "1",
                "CYCLES_BVH_LAYOUT": "BVH2", "OMP_NUM_THREADS": "1", "LC_ALL": "de_DE.UTF-8",
                "OCIO": str(self.put("broken.ocio", "not a configuration")),
                "OCIO_OPTIMIZATION_FLAGS": "0", "LD_LIBRARY_PATH": "/nonexistent",
                "LP_NATIVE_VECTOR_WIDTH": "128", "GALLIVM_PERF": "nopt", "GALLIUM_NOSSE": "1",
                "MESA_SPIRV_FORCE_UNSTRUCTURED": "1", "VK_INSTANCE_LAYERS": "VK_LAYER_evil",
                "VK_LOADER_DEBUG": "layer"}

    def render(self, scene, engine, output, environment, *settings):
        """Returns the channels of a frame, with the attributes that determine them, and the
        messages."""
        done = self.neph("render", scene, "-e", engine, "--size", "8x8", "-q", "-o", output,
                         *settings, surroundings=environment)
        *picture, texts = frames.read_exr(self.folder / output / f"{scene}_{engine}_0000.exr")
        named = {f"neph.{name}": texts[f"neph.{name}"]
                 for name in ("engine_version", "engine_build", "device")}
        return (*picture, named), done.stderr

    def assert_same(self, scene, engine, *settings):
        clean, said = self.render(scene, engine, "clean", CLEAN, *settings)
        self.assertEqual(said, "")
        hostile, said = self.render(scene, engine, "hostile", self.hostile(), *settings)
        self.assertEqual(clean, hostile)
        self.assertEqual(self.trace.read_text() if self.trace.exists() else "", "")
        return said

    def test_povray_reads_no_ini_of_the_users(self):
        self.assert_same("fence_backlit", "povray")

    def test_blender_runs_no_script_of_the_users(self):
        self.assert_same("scattering_slab_above", "cycles", "-s", "samples=1")

    def test_neph_names_ignored_variables(self):
        said = self.assert_same("fence_backlit", "march")
        for name in ("LP_NATIVE_VECTOR_WIDTH", "GALLIVM_PERF", "VK_INSTANCE_LAYERS",
                     "MESA_SPIRV_FORCE_UNSTRUCTURED", "OCIO_OPTIMIZATION_FLAGS"):
            self.assertIn(f"{name} is ignored", said)
        self.assertNotIn("Insert instance layer", said)
        self.assertNotIn("/nonexistent.so", said)

    def test_choices_that_change_no_bit_are_left(self):
        _, said = self.render("fence_backlit", "march", "threads",
                              {**CLEAN, "LP_NUM_THREADS": "1", "OCIO": "/nonexistent"})
        self.assertEqual(said, "")

    def test_an_engine_behind_a_wrapper_dies_with_neph(self):
        """SIGKILL of neph, while a script in front of the engine waits for it in another
        session."""
        bin_first = self.put_program(
            "povray",
            '#!/bin/sh\ncase "$1" in --version) exec /usr/bin/povray --version;; esac\n'
            f'echo $$ >{self.folder}/wrapper; setsid sh -c \'echo $$ >{self.folder}/engine; '
            f'exec sleep 300\'\n')
        child = self.start("render", "fence_backlit", "-e", "povray", "--size", "8x8", "-q",
                           **bin_first)
        pids = [self.folder / name for name in ("wrapper", "engine")]
        self.wait_until(
            lambda: all(path.exists() and path.read_text().endswith("\n") for path in pids))
        child.kill()
        child.wait()
        self.wait_until(
            lambda: not any(map(self.is_alive, (path.read_text().strip() for path in pids))))

    @staticmethod
    def is_alive(pid):
        try:
            return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[
                0] not in "ZX"
        # the process ended before its file was opened, or before it was read
        except (FileNotFoundError, ProcessLookupError):
            return False


if __name__ == "__main__":
    unittest.main()
