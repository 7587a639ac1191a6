#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The project's language rules: every file is understandable by itself, and no line is wider than a
page."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])
FOLDERS = ("base", "scenes", "truth", "metrics", "renderer", "harness", "scripts", "tests", "docs")
C, SCRIPT, PAGE = {".c", ".h", ".cpp", ".glsl", ".comp"}, {".py", ".md"}, {".js", ".mjs"}
GENERATED = re.compile(r"node_modules/|tests/fuzz/corpus/|tests/\w+/\w*reference_?\w*\.h$")
WIDTH = 100

COMMENT_OR_STRING = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:[^"\\\n]|\\.)*"', re.DOTALL)
COMMENT = re.compile(r"/\*.*?\*/|(?<!:)//[^\n]*", re.DOTALL)
# Labels of steps and faults that earlier articles used.
CODE = re.compile(r"\b(?:[AX](?:[1-9]|1[0-9]|2[0-6])|D(?:[1-9]|10))\b")
# Notes lie outside of the repository.
NOTE = re.compile(r"(?<![\w./-])notes/\w")
# The files that a page names: links, and paths in backticks except ones with a NAME.
LINK = re.compile(r"\]\((?!https?:)([^)#]+)\)")
PATH = re.compile(r"`((?:%s)/(?!\S*NAME)[\w./-]*)`" % "|".join(FOLDERS))
# A comment that continues a sentence from a comment above.
GOES_ON = re.compile(
    r"^(?:/\*|//)\s*(?:Of\b|The same(?:\.| (?:again|as|at|by|for|of|to|with|where)\b))")


def files(kinds):
    found = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*"))]
    for path in found + sorted(ROOT.glob("*.md")):
        name = path.relative_to(ROOT).as_posix()
        if path.suffix in kinds and path.is_file() and not GENERATED.search(name):
            yield name, path.read_text()


def spoken(name, text):
    """The parts of a file that are text for readers, each with its line."""
    kind = pathlib.Path(name).suffix
    if kind in SCRIPT:
        return list(enumerate(text.split("\n"), 1))
    pattern = COMMENT_OR_STRING if kind in C else COMMENT
    return [(text.count("\n", 0, found.start()) + 1, found[0]) for found in pattern.finditer(text)]


def anchors(text):
    """The anchors that GitHub gives the headings of a page."""
    prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    headings = re.findall(r"^#+ (.+)$", prose, re.MULTILINE)
    words = [re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower() for heading in headings]
    return {re.sub(r"[^\w\- ]", "", word).strip().replace(" ", "-") for word in words}


class Words(unittest.TestCase):
    maxDiff = None

    def refuse(self, kinds, pattern):
        """Fails for all places that match the pattern."""
        said = [(name, line, words) for name, text in files(kinds)
                for line, words in spoken(name, text)]
        self.assertGreater(len(said), 1000)
        self.assertEqual([f"{name}:{line}: {words[:80]}" for name, line, words in said
                          if pattern.search(words)], [])

    def test_nothing_has_to_be_looked_up_by_a_code(self):
        self.refuse(C | SCRIPT | PAGE, CODE)

    def test_nothing_refers_to_missing_files(self):
        self.refuse(C | SCRIPT | PAGE, NOTE)

    def test_comments_are_self_contained(self):
        self.refuse(C, GOES_ON)

    def test_pages_name_existing_files(self):
        missing = []
        for name, text in files({".md"}):
            links = [(ROOT / name).parent / link for link in LINK.findall(text)]
            missing += [f"{name}: {path}" for path in links if not path.exists()]
            # tests/ mirrors the other folders.
            missing += [f"{name}: {path}" for path in PATH.findall(text)
                        if not any((ROOT / above / path).exists() for above in ("", "tests"))]
        self.assertEqual(missing, [])

    def test_links_meet_a_heading(self):
        dead = []
        for name, text in files({".md"}):
            for path, anchor in re.findall(r"\]\((?!https?:)([^)#\s]*)#([^)]+)\)", text):
                page = (ROOT / name).parent / path if path else ROOT / name
                if page.suffix == ".md" and anchor not in anchors(page.read_text()):
                    dead.append(f"{name}: {path}#{anchor}")
        self.assertEqual(dead, [])

    def test_code_names_pages_that_are_there(self):
        missing = [f"{name}: {page}" for name, text in files(C | PAGE | {".py"})
                   for page in re.findall(r"\bdocs/\w+\.md\b", text)
                   if not (ROOT / page).exists() and "docs/NAME.md" != page]
        self.assertEqual(missing, [])

    def test_exit_codes_are_those_of_the_program(self):
        page = (ROOT / "docs/verbs.md").read_text().split("\n## Exit codes\n")[1].split("\n## ")[0]
        told = {(name, code) for code, name in re.findall(r"^\| (\d+) \| (\w+) \|", page, re.M)}
        rows = re.findall(r'\[NEPH_\w+\] = \{"(\w+)", (\d+)\}',
                          (ROOT / "base/status.c").read_text())
        self.assertGreater(len(rows), 10)
        self.assertEqual(told, set(rows))

    def test_lines_are_as_wide_as_a_page(self):
        wide = []
        for name, text in files(C | SCRIPT | PAGE):
            for number, line in enumerate(text.split("\n"), 1):
                is_row = name.endswith(".md") and line.startswith("|")
                if len(line) > WIDTH and not is_row:
                    wide.append(f"{name}:{number}")
        self.assertEqual(wide, [])


class Counter(unittest.TestCase):
    """scripts/words.py on a tree of two files."""

    def count(self, comment, name="find_row", allowed=""):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "base").mkdir()
            (root / "scripts").mkdir()
            (root / "scripts/words_allowed.txt").write_text(allowed)
            (root / "README.md").write_text("A page of plain words.\n")
            (root / "base/a.c").write_text(
                f'/* {comment} */ int {name}(int i) {{ puts("a message of five words"); }}\n')
            return subprocess.run([ROOT / "scripts/words.py"], text=True, capture_output=True,
                                  env=os.environ | {"NEPH_SOURCE_DIR": folder}, check=False)

    def test_plain_words_pass(self):
        done = self.count("The mean of all values, in metres.")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("comments 7, messages 5", done.stdout)

    def test_a_habit_a_name_and_an_old_exception_fail(self):
        for fault, words in (("comments: what/who as a noun 166.7", ("Of what is left the mean",)),
                             ("row_of() is to be named", ("The mean.", "row_of")),
                             ("old_of is no longer", ("The mean.", "find_row", "old_of"))):
            done = self.count(*words)
            self.assertEqual(done.returncode, 1)
            self.assertIn(fault, done.stderr)
        self.assertEqual(self.count("The mean.", "row_of", "row_of").returncode, 0)


if __name__ == "__main__":
    unittest.main()
