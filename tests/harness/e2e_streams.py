#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Truncated output is an error, input that never arrives is refused, and no byte from foreign files
controls the terminal."""
import json
import os
import shutil
import subprocess
import tempfile
import unittest

import frames
import neph_case

NEPH = neph_case.NEPH
VERBS = ("validate", "render", "export", "compare", "flicker", "metrics", "bake", "study",
         "benchmark", "conform", "scenes", "engines", "doctor", "fly", "view")
BLENDER = """#!/bin/sh
case "$1" in --version) echo "Blender 3.4.1"; exit 0;; esac
{body}
"""
ROOMLESS = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c",
            'mount -t tmpfs -o size=256k none "$0" && exec "$@"']


def has_small_disks():
    with tempfile.TemporaryDirectory() as folder:
        return shutil.which("unshare") and subprocess.run([*ROOMLESS, folder, "true"],
                                                          capture_output=True).returncode == 0


def neph(*arguments, timeout=120, **more):
    environment = {**os.environ, **more.pop("environment", {})}
    return subprocess.run([NEPH, *arguments], stderr=subprocess.PIPE, timeout=timeout,
                          env=environment, **{"stdout": subprocess.PIPE, **more})


class Output(neph_case.NephCase):
    def write(self, name, value):
        path = self.folder / name
        path.write_bytes(
            frames.exr_bytes(16, 12, {c: [value + 0.01 * i for i in range(192)] for c in "RGB"}))
        return path

    def test_output_that_was_cut_is_an_error_of_every_verb(self):
        a, b = self.write("a.exr", 0.5), self.write("b.exr", 0.6)
        for number in range(16):  # fewer frames are no measurement: exit 2
            self.write(f"f_{number:02}.exr", 0.5 + 0.01 * (number % 3))
        small = ["--size", "8x8", "-o", self.folder / "out"]
        commands = [["--help"], ["--version"], ["help"], *([verb, "--help"] for verb in VERBS),
                    ["validate", "--usage"], ["scenes", "white_furnace", "--json"],
                    ["scenes", "white_furnace"], ["engines", "exact"],
                    ["engines", "exact", "--json"], ["metrics"], ["metrics", "--masks", "--json"],
                    ["doctor"], ["compare", a, b], ["compare", a, b, "--json"],
                    ["flicker", "--reference", a, self.folder / "f_*.exr", "-q"],
                    ["render", "absorbing_slab", "-e", "exact", *small],
                    ["export", "absorbing_slab", "-o", self.folder / "export"],
                    ["bake", "gaussian_blob", "-o", self.folder / "blob.df3"],
                    ["validate", "absorbing_slab", "-e", "exact", "-e", "oracle", "--no-charts",
                     "-q", "--size", "8x8", "-o", self.folder / "report"]]
        with open("/dev/full", "wb") as full:
            for command in commands:
                done = neph(*command, stdout=full)
                self.assertEqual(done.returncode, 74, (command, done.stderr))
                self.assertEqual(done.stderr.count(b"the output was cut: cannot write to stdout"),
                                 1, (command, done.stderr))

    def test_a_large_step_bias_is_warned_of(self):
        for steps, is_large in (2, True), (64, False):
            done = neph("render", "height_fog_up", "-s", f"steps={steps}", "--size", "16x9", "-q",
                        "--json", "-o", self.folder)
            result, = json.loads(done.stdout)
            self.assertEqual(abs(result["step_bias"]) > 0.1, is_large, result)
            self.assertEqual(b"too bright: raise its steps" in done.stderr, is_large, done.stderr)

    def test_an_exit_code_that_says_more_stays(self):
        with open("/dev/full", "wb") as full:
            a, b = self.write("a.exr", 0.5), self.write("b.exr", 0.6)
            self.assertEqual(neph("compare", a, b, "--fail-above", "radiance:mae=0",
                                  stdout=full).returncode, 1)

    def test_a_file_that_may_not_grow_is_an_error_of_writing(self):
        for output, command in ((self.folder / "listed", ["metrics"]),
                                (None,
                                 ["render", "absorbing_slab", "-e", "exact", "-o", self.folder])):
            with open(output or os.devnull, "wb") as stdout:
                done = subprocess.run(["sh", "-c", 'ulimit -f 1; exec "$@"', "sh", NEPH,
                                       *map(str, command)], stdout=stdout,
                                      stderr=subprocess.PIPE, timeout=60)
            self.assertEqual(done.returncode, 74, done.stderr)
            self.assertIn(b"the output was cut" if output else b"File too large", done.stderr)

    def test_pipes_and_devices_are_refused_at_once(self):
        frame, fifo = self.write("a.exr", 0.5), self.folder / "fifo.exr"
        os.mkfifo(fifo)
        scene = self.folder / "fifo.yaml"
        os.mkfifo(scene)
        for command in (["compare", fifo, frame], ["compare", frame, fifo],
                        ["compare", "/dev/zero", frame], ["scenes", scene], ["render", scene],
                        ["render", "camera_dolly", "-e", "realtime", "--depth", fifo, "-o",
                         self.folder], ["render", "absorbing_slab", "-e", "oracle", "--checkpoint",
                                        fifo, "-o", self.folder]):
            done = neph(*command, timeout=20)
            self.assertEqual(done.returncode, 65, (command, done.stderr))
            self.assertIn(b"is not a regular file", done.stderr)
            self.assertIn(b"write it to a file first", done.stderr)

    def test_the_command_line_does_not_act_on_the_terminal(self):
        hostile = b"\x1b[2J\xc2\x9b2J\xe2\x80\xae\xff"
        shown = rb"\x1b[2J\u009b2J\u202e\xff"
        for command in ([hostile], ["render", b"--" + hostile], ["render", "a", hostile],
                        ["render", hostile], ["scenes", b"./" + hostile],
                        ["compare", hostile, hostile], ["render", "absorbing_slab", "-e", hostile],
                        ["render", "absorbing_slab", "-s", hostile], ["validate", hostile],
                        ["validate", "--suite", hostile]):
            done = neph(*command)
            self.assertNotEqual(done.returncode, 0, command)
            self.assertIn(shown, done.stderr, command)
            for byte in (b"\x1b", b"\xc2\x9b", b"\xe2\x80\xae", b"\xff"):
                self.assertNotIn(byte, done.stdout + done.stderr, command)

    def blender(self, body):
        surroundings = self.put_program("blender", BLENDER.format(body=body))
        neph_case.keep_trial(self.folder / "bin/blender", self.folder, "scripts/blender_render.py",
                             has_voxels=True, has_unbiased=False, has_phases=False,
                             has_spots=True)
        return {**surroundings, "XDG_CACHE_HOME": str(self.folder)}

    def test_a_full_disk_in_an_engines_words_is_named(self):
        words = "OSError: [Errno 28] No space left on device: timing.json"
        done = neph("render", "absorbing_slab", "-e", "cycles", "-o", self.folder / "out",
                    environment=self.blender(f"echo '{words}' >&2; exit 7"))
        self.assertEqual(done.returncode, 74, done.stderr)
        self.assertIn(b"the disk is full at '" + os.fsencode(self.folder / "out"), done.stderr)
        self.assertNotIn(b"its whole log is", done.stderr)  # which is removed to free space
        done = neph("render", "absorbing_slab", "-e", "cycles", "-o", self.folder / "out",
                    environment=self.blender("exit 7"))
        self.assertEqual((done.returncode, b"disk" in done.stderr), (3, False), done.stderr)

    @unittest.skipUnless(has_small_disks(), "no file systems of our own can be mounted here")
    def test_a_full_disk_without_words_is_named(self):
        small = self.folder / "small"
        small.mkdir()
        environment = {**os.environ, **self.blender("head -c 1000000 /dev/zero > big; exit 1")}
        done = subprocess.run([*ROOMLESS, small, NEPH, "render", "absorbing_slab", "-e", "cycles",
                               "-o", small / "out"],
                              capture_output=True, timeout=60, env=environment)
        self.assertEqual(done.returncode, 74, done.stderr)
        self.assertIn(b"the disk is full at '" + os.fsencode(small), done.stderr)


if __name__ == "__main__":
    unittest.main()
