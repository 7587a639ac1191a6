#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""renderer/settings.py: the page of settings agrees with the files, and an error message names the
file and the setting."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])
SCRIPT = SOURCE / "renderer" / "settings.py"
GOOD = """[first]
number = 0
kind = "switch"
default = "off"
help = "one"
"""


def run(*arguments):
    return subprocess.run([sys.executable, SCRIPT, *map(str, arguments)], capture_output=True,
                          text=True, check=False)


class Settings(unittest.TestCase):
    def test_the_page_is_current(self):
        page = run(SOURCE, "--docs")
        self.assertEqual(page.returncode, 0, page.stderr)
        self.assertEqual(page.stdout, (SOURCE / "docs" / "settings.md").read_text(),
                         "renderer/settings.py . --docs > docs/settings.md")

    def of(self, text):
        """The script's output for a pass's settings file, and the names that it generates."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, content in (("march_settings.toml", ""), ("march_params.h", ""),
                                  ("shaders/constants.h", ""),
                                  ("realtime/fog/settings.toml", text)):
                path = root / "renderer" / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(content)
            done = run(root, root / "out")
            names = root / "out" / "realtime_names.h"
            return done, names.read_text() if names.exists() else ""

    def test_names_are_in_the_order_of_the_numbers(self):
        done, names = self.of("""[second]
number = 7
constants = "SECOND"
choices = ["low", "high"]
default = "high"
help = "two"
""" + GOOD)
        self.assertEqual(done.returncode, 0, done.stderr)
        for line in ("#define RT_FIRST 0", "#define RT_SECOND 1", "#define RT_SETTING_COUNT 2",
                     "#define RT_SECOND_HIGH 1"):
            self.assertIn(line + "\n", names)

    def test_errors_name_file_and_setting(self):
        for text, words in (
                (GOOD.replace("off", "maybe"), "default is maybe, not one of: off, on"),
                (GOOD.replace('help = "one"', ""), "it has no help"),
                (GOOD + 'unit = "m"\n', "there is no key unit"),
                (GOOD.replace('"switch"', '"real"'), "a number has a range"),
                (GOOD.replace('"switch"', '"bool"'), "kind is bool"),
                (GOOD.replace('kind = "switch"\ndefault = "off"',
                              'kind = "real"\ndefault = 3\nrange = [0, 1]'), "outside 0 .. 1"),
                (GOOD.replace('kind = "switch"\ndefault = "off"',
                              'kind = "real"\ndefault = 3\nrange = [0, "MOST"]'),
                 "MOST is no number"),
                (GOOD + GOOD.replace("first", "other"), "has number 0, too; the next is 1")):
            done, _ = self.of(text)
            self.assertEqual(done.returncode, 1, words)
            self.assertIn("renderer/realtime/fog/settings.toml: setting ", done.stderr)
            self.assertIn(words, done.stderr)
        done, _ = self.of("[first\n")
        self.assertIn("renderer/realtime/fog/settings.toml: ", done.stderr)


if __name__ == "__main__":
    unittest.main()
