#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The page of the stress tests, opened from disk in a browser as by a reader.

Builds a small page with every verdict, missing values and hostile strings, in the layout of
scripts/report/README.md, and checks it against its data with check_stress.mjs. Then it plants known
faults in the page, which the checker must find.

    e2e_stress_page.py                  run the tests
    e2e_stress_page.py --fixture DIR    only write the page, for inspection
"""
import json
import pathlib
import sys
import unittest

import night
from pages import HEIGHT, HOSTILE, HOSTILE_SCRIPT, WIDTH, PageCase, lay_out, write_png

SLICE = 32
COLUMNS = [{"name": "seed", "engine": "realtime", "preset": True},
           {"name": "ours+taa_box=variance", "engine": "realtime", "preset": True},
           {"name": "cycles", "engine": "cycles", "preset": False}]
POINTS = ["", "pitch_m=0.16", "pitch_m=0.32", "pitch_m=0.64"]
PICTURES = ["worst", "worst_reference", "worst_difference", "slice", "slice_reference",
            "slice_difference", "seen_contrast_radiance", "flip_0", "flip_1", "flip_2", "flip_3",
            "flip_reference_0"]


# ----------------------------------------------------------------------------------------- data

def result(scene, column, verdict, value, measure="error", point="", why="", limit=0.2,
           infinite=False, floor=None):
    return {"scene": scene, "point": point, "measure": measure, "over": "all", "limit": limit,
            "reason": f"a few seams may be open {HOSTILE}", "column": column, "value": value,
            "infinite": infinite, "verdict": verdict, "why": why,
            "floor_column": floor and f"off+taa=on {HOSTILE}", "floor": floor,
            "floor_infinite": False, "times_floor": floor and value / floor}


def scene(name, points):
    return {"name": name, "title": f"Bars before a cloud, {name}",
            "fails": f"Tiles choose in parallel {HOSTILE}", "known": "a frame split",
            "symptom": f"all gaps of {name} blink {HOSTILE_SCRIPT}", "truth": "march",
            "width_px": WIDTH, "height_px": HEIGHT, "frames": SLICE, "steps": 8, "points": points}


def evidence(scene_name, column, point, folder):
    return {"format": "neph-exhibit-1", "pictures": [f"{name}.png" for name in PICTURES],
            "frame_step": 1, "worst_frame": 9, "row": 20, "slice_first": 0, "slice_count": SLICE,
            "flip_first": 8, "flip_count": 4, "scale": 0.05, "scene": scene_name,
            "column": column, "point": point, "size_px": [WIDTH, HEIGHT],
            "folder": f"images/{folder}"}


def results():
    fence = [result("fence", "seed", "fail", 0.25 * 2.3 ** p, point=point, floor=0.07 + 0.01 * p)
             for p, point in reversed(list(enumerate(POINTS)))]
    variance = [result("fence", "ours+taa_box=variance", "known_fail" if p else "pass",
                       0.12 * 1.7 ** p, point=point, why="not isolated yet" if p else "")
                for p, point in reversed(list(enumerate(POINTS)))]
    return fence + [
        result("fence", "seed", "fail", None, "lag", limit=8, infinite=True),
        result("veil", "seed", "no_number", None, why=f"it broke {HOSTILE}"),
        result("veil", "ours+taa_box=variance", "unexpected_pass", 0.031, why="was known"),
        *variance,
        result("veil", "seed", "flake", 3.25, "flicker", why="fails on some devices", limit=1),
        result("fog", "cycles", "not_rendered", None, why="stopped after 300 s"),
        result("fog", "seed", "pass", 1.25e-7), result("fog", "seed", "skip", None, "lag"),
        result("blind", "cycles", "cannot", None, why="cannot: Rayleigh phase function"),
        result("blind", "seed", "not_yet", None),
        result("fog", "cycles", "missing", None, "bad_values", why="it is not installed", limit=0)]


def page_data():
    rows = results()
    verdicts = [row["verdict"] for row in rows]
    return {"format": "neph-failure-2", "device": f"llvmpipe {HOSTILE}", "tier": "full",
            "columns": COLUMNS,
            "floors": [{"column": "seed", "floors": ["off+taa=on", "off+taa=on"]}],
            "scenes": [scene("fog", [""]), scene("fence", POINTS), scene("veil", [""]),
                       scene("blind", [""])],
            "compared": sum(v in ("pass", "fail", "known_fail", "unexpected_pass", "flake")
                            for v in verdicts),
            "news": sum(v in ("fail", "no_number", "unexpected_pass") for v in verdicts),
            "counts": {v: verdicts.count(v) for v in sorted(set(verdicts))}, "verdict": "fail",
            "seconds": 103.5, "frames": 1224, "results": rows, "state": "interrupted",
            "created_utc": "2026-11-25T10:00:00Z", "neph_version": "0.1.0",
            "progress": {"done": 14, "total": 20, "left_s": 41.5},
            "pictures": {"limit_bytes": 60000000, "bytes": 59200000, "left_out": 2},
            "difference_colours": ["#053061", "#4393c3", "#f7f7f7", "#d6604d", "#67001f"],
            "evidence": [evidence("fence", "seed", POINTS[-1], "a1"),
                         evidence("veil", "ours+taa_box=variance", "", "b2")],
            "commands": {"fence": {column["name"]: f"neph validate --only fence {HOSTILE}"
                                   for column in COLUMNS[:2]}}}


# --------------------------------------------------------------------------------------- layout

def shade(name):
    """Bars; the frames of a flip-book differ."""
    shift = int(name[-1]) if name[-1].isdigit() else 0

    def pixel(i, j):
        return (40, 60, 90) if (i + shift) % 4 == 0 else (150 + j, 160, 170)
    return pixel


def build(folder, data=None):
    data = data or page_data()
    lay_out(folder, "stress", "NEPH_STRESS", data)
    for item in data["evidence"]:
        for name in item["pictures"]:
            height = SLICE if name.startswith("slice") else HEIGHT
            write_png(folder / item["folder"] / name, shade(name[:-4]), WIDTH, height)


# ---------------------------------------------------------------------------------------- tests

class Page(PageCase):
    """The page in headless Chromium."""
    NAME = "stress"
    build = staticmethod(build)

    def test_a_good_page_has_no_faults(self):
        self.assert_page_is_good(self.good, "--quick")

    @night.of_the_night
    def test_in_all_windows(self):
        """In a narrow window with reduced motion, and in dark mode."""
        self.assert_page_is_good(self.good)

    @night.of_the_night
    def test_a_page_of_a_run_that_has_just_begun(self):
        data = page_data()
        data.update(results=[result("blind", "seed", "not_yet", None)], evidence=[], commands={},
                    compared=0, news=0, state="running", verdict="fail", counts={"not_yet": 1})
        data["scenes"] = data["scenes"][-1:]
        data["pictures"]["left_out"] = 0
        self.assert_page_is_good(self.built("begun", data), "--quick")

    @night.of_the_night
    def test_each_of_several_faults_is_found(self):
        """Independent faults in one page."""
        folder = self.copy_with((
            ('pass: ["✓", "passes", "pass-word"]', 'pass: ["✓", "", "pass-word"]'),
            ("if (timer !== null) return stop();", "if (timer !== null) return null;"),
            ("el(\"p\", null, scene.fails)",
             "Object.assign(el(\"p\"), { innerHTML: scene.fails })"),
            ("const told = order.filter((scene) => of(scene).some(hasNumber));",
             "const told = order;")))
        (folder / "images/a1/slice.png").unlink()
        data = page_data()
        data["results"][0]["value"] *= 1.001
        data["results"][1]["floor"] *= 1.001
        data["results"][-1]["why"] = "another reason"
        (folder / "data.json").write_text(json.dumps(data))
        self.assert_finds(self.check(folder, "--quick"), (
            ("a verdict without a word", "a verdict without a word"),
            ("a flip-book that cannot be stopped", "that is stopped turns"),
            ("markup from data", "markup that is none of the page's"),
            ("a row without a number", "a row without a number: blind"),
            ("a missing picture", "images/a1/slice.png"),
            ("a number that differs", "the number"),
            ("a floor that differs", "the floor"),
            ("a reason that is not said", "another reason")))


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--fixture":
        build(pathlib.Path(sys.argv[2]))
    else:
        unittest.main(verbosity=2)
