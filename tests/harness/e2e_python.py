#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The Python module: its numbers are those of the commands for files with the same values, to the
bit, and what is wrong is an exception that says what and where. It needs numpy, which Debian's
Python has."""
import datetime
import importlib.util
import json
import os
import pathlib
import re
import struct
import subprocess
import sys
import unittest
import zlib

from frames import exr_bytes, read_exr
from neph_case import NEPH, ROOT, NephCase, run
from night import of_the_night

SYSTEM = "/usr/bin/python3"
if not importlib.util.find_spec("numpy") and os.path.exists(SYSTEM) and sys.executable != SYSTEM:
    os.execv(SYSTEM, [SYSTEM, *sys.argv])
LIBRARY = pathlib.Path(NEPH).parent / "library/libneph_metrics.so.0"
if importlib.util.find_spec("numpy"):
    import numpy
    os.environ["NEPH_METRICS_LIBRARY"] = str(LIBRARY)
    sys.path.insert(0, str(ROOT / "python"))
    import neph

WIDTH, HEIGHT = 48, 36


def png_bytes(codes):
    """RGB codes of 8 or 16 bits, (height, width, 3)."""
    height, width, _ = codes.shape
    bits = 8 * codes.dtype.itemsize
    rows = codes.astype(codes.dtype.newbyteorder(">")).reshape(height, -1)

    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data +
                struct.pack(">I", zlib.crc32(kind + data)))
    return (b"\x89PNG\r\n\x1a\n" +
            chunk(b"IHDR", struct.pack(">2I5B", width, height, bits, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row.tobytes() for row in rows))) +
            chunk(b"IEND", b""))


def planes(frame):
    """{channel: plane} of an image or of channels by name."""
    if not isinstance(frame, dict):
        return {name: frame[:, :, c] for c, name in enumerate("RGB")}
    return {channel: plane for name, values in frame.items()
            for channel, plane in (planes(values) if name == "rgb" else {name: values}).items()}


@unittest.skipUnless(importlib.util.find_spec("numpy"), "skipped: no numpy (python3-numpy)")
class Python(NephCase):
    def setUp(self):
        super().setUp()
        self.random = numpy.random.default_rng(20261130)

    def image(self, gain=1.0):
        """Light from 0.0 to about 2 with edges and noise."""
        y, x = numpy.mgrid[0:HEIGHT, 0:WIDTH]
        base = 0.5 + 0.5 * numpy.sin(x / 5.0) * numpy.cos(y / 7.0) + (x > 30)
        noise = 0.02 * self.random.random((HEIGHT, WIDTH, 3))
        return (gain * base[:, :, None] * (1.0, 0.8, 0.6) + noise).astype(numpy.float32)

    def write(self, name, frame):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(frame, dict) or frame.dtype.kind == "f":
            channels = {channel: plane.ravel().tolist() for channel, plane in planes(frame).items()}
            path.with_suffix(".exr").write_bytes(exr_bytes(WIDTH, HEIGHT, channels))
        else:
            path.with_suffix(".png").write_bytes(png_bytes(frame))

    def command(self, verb, reference, test, *words):
        """What the command says of these frames as files."""
        for side, frames in (("reference", reference), ("test", test)):
            for i, frame in enumerate(frames):
                self.write(f"{side}/frame_{i:04}", frame)
        names = ["-r", self.folder / "reference"] if reference else []
        done = run(verb, *names, self.folder / "test", "--json", *words)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads(done.stdout)

    def check_same(self, said, result):
        """All numbers, their intervals and the findings; files have other names."""
        files = {"reference", "test", "window", "largest_error"}
        self.assertEqual(set(said), set(result.document))
        for key in set(said) - files:
            self.assertEqual(said[key], result.document[key], key)
        self.assertEqual(len(said["measurements"]), len(result.numbers))
        for told, number in zip(said["measurements"], result.numbers):
            value = told["value"]
            self.assertEqual((told["metric"], told["mask"], told["quantity"]),
                             (number.metric, number.mask, number.quantity))
            self.assertTrue(value == number.value or value is None and number.undefined_because)
        self.assertGreater(len(result.numbers), 5)

    def test_compare_gives_the_numbers_of_the_command(self):
        a, b = self.image(), self.image(1.01)
        self.check_same(self.command("compare", [a], [b]), neph.compare(a, b))

    def test_depth_and_masks(self):
        depth = numpy.full((HEIGHT, WIDTH), 3.0, numpy.float32)
        depth[:, 20:] = numpy.inf
        a, b = ({"rgb": self.image(gain), "Z": depth} for gain in (1.0, 0.98))
        said = self.command("compare", [a], [b], "--mask", "sky", "-m", "error,ssim")
        result = neph.compare(a, b, mask="sky", metric=["error", "ssim"])
        self.check_same(said, result)
        self.assertEqual({number.mask for number in result.numbers}, {"sky"})

    def test_codes_of_8_and_16_bits(self):
        for kind, largest in ((numpy.uint8, 255), (numpy.uint16, 65535)):
            with self.subTest(kind=kind):
                a, b = ((largest * self.random.random((HEIGHT, WIDTH, 3))).astype(kind)
                        for _ in range(2))
                self.check_same(self.command("compare", [a], [b], "-m", "error,flip"),
                                neph.compare(a, b, metric="error,flip"))

    def test_flicker_gives_the_numbers_of_the_command(self):
        frames = [self.image() for _ in range(20)]
        still = [frames[0]]
        words = ("-s", "lag:step_frame=8", "--fps", "30", "--warm-up", "3", "-m", "flicker,lag")
        self.check_same(self.command("flicker", still, frames, *words),
                        neph.flicker(frames, reference=frames[0], settings=["lag:step_frame=8"],
                                     fps=30, warm_up=3, metric="flicker,lag"))

    def test_flicker_without_a_reference(self):
        frames = numpy.stack([self.image() for _ in range(16)])
        self.check_same(self.command("flicker", [], frames), neph.flicker(frames))

    def test_any_layout_in_memory_is_the_same_image(self):
        a, b = self.image(), self.image(1.1)
        wanted = repr(neph.compare(a, b).numbers)  # where NaN is NaN, in Python 3.13, too
        wide = numpy.zeros((2 * HEIGHT, 3 * WIDTH, 5), numpy.float32)
        wide[1::2, ::3, 1:4] = b
        turned = numpy.asfortranarray(b)
        frozen = b.copy()
        frozen.flags.writeable = False
        flipped = b[::-1, ::-1].copy()[::-1, ::-1]
        for other in (wide[1::2, ::3, 1:4], turned, frozen, flipped, b.astype(numpy.float64),
                      {"R": b[..., 0], "G": b[..., 1], "B": b[..., 2]},
                      b.astype(">f4")):
            self.assertEqual(repr(neph.compare(a, other).numbers), wanted)

    def test_what_is_wrong_is_told(self):
        a, b = self.image(), self.image(1.1)
        bad = b.copy()
        bad[2, 3, 1] = numpy.nan
        cases = (
            (ValueError, "test.*shape", lambda: neph.compare(a, b[..., :2])),
            (ValueError, "test.*no pixels", lambda: neph.compare(a, b[:0])),
            (ValueError, "test.*36", lambda: neph.compare(a, b[:, :12])),
            (TypeError, "test.*int64", lambda: neph.compare(a, b.astype(numpy.int64))),
            (TypeError, "reference.*<U1", lambda: neph.compare("x", b)),
            (TypeError, "reference.*complex", lambda: neph.compare(a.astype(complex), b)),
            (ValueError, r"test\[1\].*not finite.*pixel \(3, 2\)",
             lambda: neph.compare(a, [b, bad])),
            (ValueError, "negative", lambda: neph.compare(a, -b)),
            (ValueError, "no extractor or metric 'nope'",
             lambda: neph.compare(a, b, metric="nope")),
            (ValueError, "fps.*number", lambda: neph.compare(a, b, fps="fast")),
            (ValueError, "warm-up.*whole", lambda: neph.compare(a, b, warm_up=0.5)),
            (ValueError, "mask.*depth_edge", lambda: neph.compare(a, b, mask="depth_edge")),
            (ValueError, "3 reference and 2 test", lambda: neph.compare([a] * 3, [b] * 2)),
            (ValueError, "display image", lambda: neph.compare(a, (100 * b).astype(numpy.uint8))),
            (ValueError, "different sizes",
             lambda: neph.compare(a, {"rgb": b, "Z": numpy.ones((3, 3), numpy.float32)})),
            (ValueError, "Z.*no plane", lambda: neph.compare(a, {"rgb": b, "Z": 1.0})),
            (ValueError, "no channels", lambda: neph.compare(a, {})),
            (ValueError, "translucent", lambda: neph.compare(
                a, numpy.zeros((HEIGHT, WIDTH, 4), numpy.uint8))),
            (ValueError, "Setting|setting", lambda: neph.compare(a, b, settings=["ssim"])),
            (ValueError, "metric: 'error.x00x' has a zero byte",
             lambda: neph.compare(a, b, metric="error\0x")),
            (ValueError, "test, the name of a channel: 'Z.x00' has a zero byte",
             lambda: neph.compare(a, {"rgb": b, "Z\0": b[..., 0]})),
            (TypeError, "settings: None is no text", lambda: neph.compare(a, b, settings=[None])),
            (ValueError, "reference: 4294967305 x 1 pixels: 2147483647 are the most",
             lambda: neph.compare(numpy.broadcast_to(numpy.float32(1), (1, 2**32 + 9)), b)),
            (TypeError, "reference: masked pixels",
             lambda: neph.compare(numpy.ma.masked_greater(a, 1), b)),
        )
        for kind, words, wrong in cases:
            with self.subTest(words=words), self.assertRaisesRegex(kind, words):
                wrong()

    def test_frozen_frames_have_a_result_all_the_same(self):
        frames = [self.image()] * 16
        with self.assertRaisesRegex(neph.FrozenError, r"15 of 16.*test\[1\]") as caught:
            neph.flicker(frames, reference=frames[0])
        self.assertGreater(len(caught.exception.result.numbers), 5)
        neph.flicker(frames, reference=frames[0], frozen_ok=True)

    def test_tables_of_pandas(self):
        a, b = self.image(), self.image(1.1)
        result = neph.compare(a, [b, 2 * b], metric="error")
        if not importlib.util.find_spec("pandas"):
            with self.assertRaisesRegex(ImportError, "pandas"):
                result.table()
            self.skipTest("skipped: no pandas (python3-pandas)")
        from pandas import isna
        table = result.table()
        self.assertEqual([str(table.dtypes[name]) for name in ("frame", "value", "low", "high")],
                         ["Int64", "float64", "float64", "float64"])
        self.assertEqual(len(table), len(result.numbers))
        for number, row in zip(result.numbers, table.to_dict("records")):
            self.assertEqual(list(row), list(vars(number)))
            for name, value in vars(number).items():
                self.assertEqual(None if isna(row[name]) else row[name],
                                 None if isna(value) else value, (number, name))
        rmse = table[(table["metric"] == "rmse") & (table["mask"] == "all")].set_index("frame")
        self.assertEqual(rmse["value"][1], result.find("rmse", frame=1).value)
        self.assertEqual(list(neph.Result((), {}).table()), list(table))

    def test_options_of_numpy_and_single_words(self):
        a, b = self.image(), self.image(1.1)
        wanted = repr(neph.compare(a, b, metric=["flip"], settings=["flip:tone=aces"], fps=30.0,
                                   warm_up=0, rings=True).numbers)
        self.assertEqual(wanted, repr(neph.compare(
            a, b, metric="flip", settings="flip:tone=aces", fps=numpy.float32(30),
            warm_up=numpy.int64(0), rings=numpy.bool_(True)).numbers))

    def fuzz(self, *words):
        done = subprocess.run([sys.executable, ROOT / "tests/harness/python_fuzz.py", *words],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout[-500:] + done.stderr[-5000:])
        counts = done.stdout.splitlines()[-1]
        for end in "numbers", "InputError", "TypeError", "ValueError":
            self.assertIn(f"'{end}'", counts)

    def test_random_calls_end_in_numbers_or_in_exceptions(self):
        self.fuzz("--seed", "47", "--count", "1000")

    @of_the_night
    def test_random_calls_of_a_night(self):
        self.fuzz("--seed", f"{datetime.date.today():%Y%m%d}", "--seconds", "120")

    def test_the_examples_of_the_page(self):
        """Of docs/library.md, one after the other."""
        text = (ROOT / "docs/library.md").read_text(encoding="utf-8")
        blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
        self.assertEqual(len(blocks), 3)
        done = subprocess.run([sys.executable, "-c", "".join(blocks)], capture_output=True,
                              text=True, check=False,
                              env={**os.environ, "PYTHONPATH": str(ROOT / "python")})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(len(done.stdout.splitlines()), 3)

    def test_a_wheel_in_a_fresh_environment(self):
        """Without a network; the library is the one that is built already."""
        if not importlib.util.find_spec("ensurepip"):
            self.skipTest("skipped: no venv (python3-venv)")
        place = self.folder / "venv"
        python = place / "bin/python"

        def succeed(*words):
            done = subprocess.run([str(word) for word in words], capture_output=True, text=True,
                                  cwd=self.folder, check=False,
                                  env={**os.environ, "PIP_NO_INDEX": "1"})
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            return done.stdout
        succeed(sys.executable, "-m", "venv", "--system-site-packages", place)
        succeed(python, "-m", "pip", "install", "--no-deps", ROOT)
        os.environ.pop("NEPH_METRICS_LIBRARY")
        self.addCleanup(os.environ.update, {"NEPH_METRICS_LIBRARY": str(LIBRARY)})
        said = succeed(python, "-c", "import neph, numpy as n; a = n.full((8, 8), 2.0);"
                       "print(neph.__file__, neph.compare(a, 1.5 * a)['rel_bias'].value)")
        self.assertTrue(said.startswith(str(place)), said)
        self.assertTrue(said.endswith(" 0.5\n"), said)


FIGURE = ROOT / "docs/examples/flicker_figure.py"
# In place of matplotlib where it is absent: nothing is drawn, a file says so.
NO_PYPLOT = """import pathlib
from unittest.mock import MagicMock
def subplots(*sizes, **options):
    figure = MagicMock()
    figure.savefig.side_effect = lambda name: pathlib.Path(name).write_text("not drawn")
    return figure, (MagicMock(), MagicMock())
"""


@unittest.skipUnless(importlib.util.find_spec("numpy"), "skipped: no numpy (python3-numpy)")
class Figure(NephCase):
    """docs/examples/flicker_figure.py, small."""

    def run_script(self):
        text, count = re.subn(r'FRAMES, WARM_UP = .*|"96x54"', lambda found: {
            "F": "FRAMES, WARM_UP = 20, 4", '"': '"16x9"'}[found[0][0]], FIGURE.read_text())
        self.assertEqual(count, 2)
        self.put("figure.py", text)
        (self.folder / "bin").mkdir(exist_ok=True)
        (self.folder / "bin/neph").symlink_to(NEPH)
        return subprocess.run([sys.executable, "figure.py"], cwd=self.folder, capture_output=True,
                              text=True, check=False, env={
                                  **os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}",
                                  "PYTHONPATH": f"{self.folder}:{ROOT}/python"})

    def test_two_presets_in_a_figure(self):
        has_matplotlib = importlib.util.find_spec("matplotlib")
        if not has_matplotlib:
            self.put("matplotlib/__init__.py", "")
            self.put("matplotlib/pyplot.py", NO_PYPLOT)
        done = self.run_script()
        self.assertEqual((done.returncode, done.stdout), (0, "flicker_figure.svg\n"), done.stderr)
        text = (self.folder / "flicker_figure.svg").read_text()
        if not has_matplotlib:
            self.assertEqual(text, "not drawn")
            self.skipTest("skipped: no matplotlib (python3-matplotlib): measured, but not drawn")
        for words in ("<svg", "<!-- Error -->", "<!-- Flicker seen -->", "<!-- depth edges -->",
                      "<!-- fixed -->", "<!-- ours -->"):
            self.assertIn(words, text)

    def test_without_matplotlib(self):
        self.put("matplotlib/__init__.py", "raise ImportError('No module named matplotlib')")
        done = self.run_script()
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr, "flicker_figure.py: No module named matplotlib: apt install "
                                      "python3-matplotlib\n")

    def test_it_reads_the_frames_of_neph(self):
        self.neph("render", "fence_drift", "-e", "exact", "--size", "11x18", "-q",
                  "-o", self.folder)
        path, = self.folder.glob("*.exr")
        _, source = FIGURE.read_text().split("# %% Frames as mappings of channels\n")
        names = {"numpy": numpy, "struct": struct, "zlib": zlib}
        exec(source.split("def render(")[0], names)
        width, height, wanted, _ = read_exr(path)
        channels = names["read_exr"](path)
        self.assertEqual(set(channels), set(wanted))
        for name, plane in channels.items():
            self.assertEqual(plane.shape, (height, width))
            self.assertEqual(plane.tobytes(), wanted[name].tobytes(), name)


if __name__ == "__main__":
    unittest.main()
