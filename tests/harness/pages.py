# SPDX-License-Identifier: MIT
"""Pages for tests: in the C program's layout, and checked in headless Chromium."""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

ROOT = pathlib.Path(os.environ.get("NEPH_SOURCE_DIR")
                    or pathlib.Path(__file__).resolve().parents[2])
PAGE = ROOT / "scripts" / "report"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
HOSTILE = '<img src=x onerror=alert(1)>'
HOSTILE_SCRIPT = '</script><script>window.NEPH_PWNED = 1</script>'
WIDTH, HEIGHT = 96, 54


def write_png(path, pixel, width=WIDTH, height=HEIGHT):
    """An 8-bit RGB image of `pixel(i, j)`, strictly by the PNG specification."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = b"".join(b"\0" + bytes(c for i in range(width) for c in pixel(i, j))
                    for j in range(height))

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I",
                                                                        zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                     chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def write_data(folder, variable, data):
    text = json.dumps(data, ensure_ascii=False, allow_nan=False)
    escaped = text.replace("<", "\\u003c")
    (folder / "data.json").write_text(text)
    (folder / "data.js").write_text(f"window.{variable} = {escaped};\n")


def lay_out(folder, name, variable, data, before=()):
    """A page without its images; its script is loaded after the scripts `before`."""
    scripts = [*before, f"{name}.js"]
    folder.mkdir(parents=True, exist_ok=True)
    text = (PAGE / "page.html").read_text().replace("@title@", f"Nephelometer {name}")
    text = text.replace("@files@", "".join(f'<script src="{script}" defer></script>\n'
                                           for script in scripts))
    (folder / "index.html").write_text(text.replace("@words@", (PAGE / f"{name}.html").read_text()))
    for source in ("report.css", "page.js", *scripts):
        shutil.copy(PAGE / source, folder)
    write_data(folder, variable, data)


def node(*arguments, timeout=300):
    return subprocess.run(["node", *map(str, arguments)], capture_output=True, text=True,
                          timeout=timeout, check=False)


def skip_without_a_browser(what):
    if not os.path.exists(CHROMIUM):
        print(f"SKIPPED: {CHROMIUM} is not installed, so {what} was NOT tested "
              "(apt-get install chromium)", file=sys.stderr)
        raise unittest.SkipTest(f"{CHROMIUM} is not installed")


class PageCase(unittest.TestCase):
    """A page NAME that build() creates, in a folder of its own."""
    NAME = ""

    @staticmethod
    def build(folder, data=None):
        raise NotImplementedError

    @classmethod
    def setUpClass(cls):
        skip_without_a_browser(f"page {cls.NAME}")
        cls.temporary = tempfile.TemporaryDirectory(prefix=f"neph_{cls.NAME}_page_")
        cls.good = pathlib.Path(cls.temporary.name, "good")
        cls.build(cls.good)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def folder(self, name):
        return pathlib.Path(self.temporary.name, name)

    def check(self, folder, *options):
        return node(PAGE / f"check_{self.NAME}.mjs", *options, folder)

    def assert_page_is_good(self, folder, *options):
        done = self.check(folder, *options)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def built(self, name, data):
        self.build(self.folder(name), data)
        return self.folder(name)

    def copy_with(self, faults, name="faults"):
        """A copy of the good page with replaced words in its script."""
        folder = self.folder(name)
        shutil.copytree(self.good, folder)
        script = folder / f"{self.NAME}.js"
        text = script.read_text()
        for right, wrong in faults:
            self.assertIn(right, text)
            text = text.replace(right, wrong)
        script.write_text(text)
        return folder

    def assert_finds(self, done, expected):
        """Each fault is reported; `expected`: its kind, and words of the message."""
        self.assertEqual(done.returncode, 1)
        for what, words in expected:
            with self.subTest(what):
                self.assertIn(words, done.stdout)
