#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""libneph_metrics as an installation has it: its names are those of the header and of the list, and
its example works by pkg-config, by CMake and from C++."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

from neph_case import NEPH, ROOT, scratch
from night import of_the_night

HEADER = ROOT / "library/neph_metrics.h"
EXAMPLE = ROOT / "library/example.c"
SYSTEM = "/usr/bin/python3"  # Debian's, which has numpy
CC = ["-std=c17", "-Wall", "-Wextra", "-pedantic", "-Werror"]
PROJECT = """cmake_minimum_required(VERSION 3.25)
project(example C)
find_package(neph_metrics 0.1 REQUIRED)
add_executable(example {example})
target_link_libraries(example PRIVATE neph::metrics)
"""

# Every NULL that a caller may pass by mistake is a status with a reason.
NULLS = """#include <neph_metrics.h>
#include <stdio.h>
int main(void)
{
    const float samples[4] = {1, 1, 1, 1};
    struct nephm_error error;
    struct nephm_number number;
    nephm_image *image = NULL;
    nephm_task *task = NULL;
    nephm_result *result = NULL;
    int wrong = nephm_image_create(2, 2, &image, NULL) + nephm_task_create(0, &task, NULL);
    wrong += nephm_image_set_floats(NULL, "R", samples, 4, 8, &error) != NEPHM_ERR_USAGE;
    wrong += nephm_image_set_floats(image, "R", NULL, 4, 8, &error) != NEPHM_ERR_USAGE;
    wrong += nephm_image_set_floats(image, NULL, samples, 4, 8, &error) != NEPHM_ERR_USAGE;
    wrong += nephm_image_set_srgb_codes(image, "R", NULL, 1, 1, 2, &error) != NEPHM_ERR_USAGE;
    wrong += nephm_image_set_floats(image, "R", samples, 4, 8, &error);
    wrong += nephm_image_set_text(NULL, "a", "b", &error) != NEPHM_ERR_USAGE;
    wrong += nephm_image_set_text(image, NULL, "b", &error) != NEPHM_ERR_USAGE;
    wrong += nephm_image_set_text(image, "a", NULL, &error) != NEPHM_ERR_USAGE;
    wrong += nephm_task_set(NULL, "fps", "30", &error) != NEPHM_ERR_USAGE;
    wrong += nephm_task_set(task, NULL, "30", &error) != NEPHM_ERR_USAGE;
    wrong += nephm_task_set(task, "fps", NULL, &error) != NEPHM_ERR_USAGE;
    const nephm_image *images[2] = {image, NULL};
    wrong += nephm_task_run(task, images, 1, images, 2, &result, &error) != NEPHM_ERR_USAGE;
    wrong += nephm_task_run(task, NULL, 1, images, 1, &result, &error) != NEPHM_ERR_USAGE;
    wrong += nephm_task_run(NULL, images, 1, images, 1, &result, &error) != NEPHM_ERR_USAGE;
    wrong += nephm_result_count(NULL) != 0 || nephm_result_json(NULL);
    wrong += nephm_result_number(NULL, 0, &number, &error) != NEPHM_ERR_USAGE;
    wrong += nephm_task_run(task, images, 1, images, 1, &result, &error);
    nephm_result_destroy(result);
    nephm_task_destroy(task);
    nephm_image_destroy(image);
    printf("%d wrong\\n", wrong);
    return 0;
}
"""


def run(*words, **environment):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True,
                          timeout=3600, env={**os.environ, **environment}, check=False)


class Library(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = scratch(cls.addClassCleanup)
        cls.prefix = cls.folder / "installed"
        build = pathlib.Path(NEPH).parent
        done = run("cmake", "--install", build, "--prefix", cls.prefix)
        assert done.returncode == 0, done.stderr
        cls.shared, = cls.prefix.rglob("libneph_metrics.so.0")
        cls.packages, = cls.prefix.rglob("pkgconfig")

    def flags(self):
        done = run("pkg-config", "--cflags", "--libs", "neph_metrics",
                   PKG_CONFIG_PATH=str(self.packages))
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.split()

    def example(self, program):
        """What the example prints."""
        done = run(program, LD_LIBRARY_PATH=str(self.shared.parent))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def test_names_are_those_of_the_header_and_of_the_list(self):
        exported = {line.split()[-1].split("@")[0]
                    for line in run("nm", "-D", "--defined-only", self.shared).stdout.splitlines()
                    if " A " not in line}
        header = HEADER.read_text(encoding="utf-8")
        declared = set(re.findall(r"NEPHM_API [^;(#]*?\b(nephm_\w+)\(", header))
        listed = set(re.findall(r"^\s+(nephm_\w+);$", HEADER.with_suffix(".symbols").read_text(
            encoding="utf-8"), re.MULTILINE))
        self.assertEqual(exported, declared)
        self.assertEqual(exported, listed)
        self.assertGreater(len(exported), 10)

    def test_it_ends_no_process_and_prints_nothing(self):
        """The house's ways to end a process or to write on stdout are not part of it."""
        used = {line.split()[-1].split("@")[0]
                for line in run("nm", "-D", "--undefined-only", self.shared).stdout.splitlines()}
        self.assertIn("memcpy", used)
        self.assertFalse(used & {"exit", "_exit", "abort", "sigaction", "signal", "putchar", "puts",
                                 "printf", "__printf_chk"}, used)

    def test_the_example_by_pkg_config(self):
        program = self.folder / "example"
        done = run("cc", *CC, EXAMPLE, *self.flags(), "-o", program)
        self.assertEqual(done.returncode, 0, done.stderr)
        said = self.example(program)
        # The test is 1.01 times the reference.
        self.assertRegex(said, r"(?m)^max_rel of radiance over all: 0.01$")

    def test_the_example_by_cmake(self):
        source = self.folder / "project"
        source.mkdir()
        (source / "CMakeLists.txt").write_text(PROJECT.format(example=EXAMPLE), encoding="utf-8")
        for words in (("-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}"),
                      ("--build", source / "build")):
            done = run("cmake", *words)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("over all", self.example(source / "build/example"))

    def test_the_python_module_finds_the_library(self):
        """Also in a tree that was moved."""
        module, = self.prefix.rglob("neph/__init__.py")
        moved = self.prefix.rename(self.folder / "moved")
        self.addCleanup(moved.rename, self.prefix)
        place = moved / module.parent.parent.relative_to(self.prefix)
        done = run(SYSTEM if os.path.exists(SYSTEM) else sys.executable, "-c",
                   "import neph; print(neph.version(), neph._library.find())",
                   PYTHONPATH=str(place), NEPH_METRICS_LIBRARY="")
        if "No module named 'numpy'" in done.stderr:
            self.skipTest("skipped: no numpy (python3-numpy)")
        self.assertEqual(done.returncode, 0, done.stderr)
        version, library = done.stdout.split()
        self.assertTrue(os.path.samefile(library, moved / self.shared.relative_to(self.prefix)))

    def test_null_is_a_status(self):
        source = self.folder / "nulls.c"
        source.write_text(NULLS, encoding="utf-8")
        done = run("cc", *CC, source, *self.flags(), "-o", self.folder / "nulls")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.example(self.folder / "nulls"), "0 wrong\n")

    def test_the_header_in_cplusplus(self):
        source = self.folder / "header.cpp"
        source.write_text('#include <neph_metrics.h>\n'
                          'int main() { return nephm_version() ? 0 : 1; }\n', encoding="utf-8")
        done = run("c++", "-std=c++17", "-Wall", "-Wextra", "-Werror", source, *self.flags(), "-o",
                   self.folder / "header")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.example(self.folder / "header")


class Threads(unittest.TestCase):
    @of_the_night
    def test_a_thousand_images_on_eight_threads(self):
        """Under the thread sanitizer, which ends the program at its first word."""
        folder, source = scratch(self.addCleanup), ROOT / "library/example_threads.c"
        build = folder / "build"
        for words in (("cmake", "-S", ROOT, "-B", build, "-DNEPH_SANITIZE=thread",
                       "-DBUILD_TESTING=OFF",
                       f"-DNEPH_UNSANITIZED_FROM={pathlib.Path(NEPH).parent}"),
                      ("cmake", "--build", build, "--target", "neph_metrics_shared"),
                      ("cc", "-std=gnu17", "-O1", "-fsanitize=thread", f"-I{HEADER.parent}", source,
                       f"-L{build}/library", f"-Wl,-rpath,{build}/library", "-lneph_metrics",
                       "-lpthread", "-o", folder / "threads")):
            done = run(*words)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        done = run(folder / "threads", TSAN_OPTIONS="halt_on_error=1")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout, "1000 images on 8 threads: 0 failures\n")


if __name__ == "__main__":
    unittest.main()
