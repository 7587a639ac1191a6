#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The report's web page, opened from disk in a browser as by a reader.

Builds a small report with every status, missing values and hostile strings, in the layout of
scripts/report/README.md, and checks the page against its data with check_report.mjs. Then it plants
known faults in the report, which the checker must find.

    e2e_report_page.py                  run the tests
    e2e_report_page.py --fixture DIR    only write the report, for inspection
"""
import copy
import json
import math
import pathlib
import shutil
import sys
import tempfile
import unittest

import night
from pages import (HEIGHT, HOSTILE, HOSTILE_SCRIPT, PAGE, WIDTH, PageCase, lay_out, node,
                   write_data, write_png)

VENDORED = {
    "vega.min.js": "node_modules/vega/build/vega.min.js",
    "vega-lite.min.js": "node_modules/vega-lite/build/vega-lite.min.js",
    "vega-embed.min.js": "node_modules/vega-embed/build/vega-embed.min.js",
    "LICENSES.txt": "vendor-licences.txt",
}
STOPS = [(0x05, 0x30, 0x61), (0x43, 0x93, 0xC3), (0xF7, 0xF7, 0xF7), (0xD6, 0x60, 0x4D),
         (0x67, 0x00, 0x1F)]
UNIT = "W m⁻² sr⁻¹"


# ------------------------------------------------------------------------------------------- images

def cloud(i, j, shift):
    """A shape like a cloud bank: 0..1."""
    x, y = i / WIDTH, j / HEIGHT
    bank = math.exp(-((y - 0.62 - 0.07 * math.sin(7 * x + shift)) / 0.16) ** 2)
    return bank * (0.75 + 0.25 * math.sin(23 * x + 9 * y + shift) * math.cos(17 * y))


def picture(shift):
    def pixel(i, j):
        density, y = cloud(i, j, shift), j / HEIGHT
        return tuple(int(255 * min(1, (1 - density) * sky * (0.55 + 0.45 * y) + 0.96 * density))
                     for sky in (0.45, 0.62, 0.86))
    return pixel


def difference(shift, gain):
    def pixel(i, j):
        signed = max(-1.0, min(1.0, gain * (cloud(i, j, shift) - cloud(i, j, 0)) + 0.1 *
                               (((i * 7919 + j * 104729) * 2654435761 >> 13 & 255) / 255 - 0.5)))
        place = (signed + 1) / 2 * (len(STOPS) - 1)
        k = min(int(place), len(STOPS) - 2)
        return tuple(round(a + (b - a) * (place - k)) for a, b in zip(STOPS[k], STOPS[k + 1]))
    return pixel


# ----------------------------------------------------------------------------------------- data

# Possible output of a failed child process: a page of text, which must not be on the front page.
LOG = f"exit status 3: {HOSTILE}\n" + "\n".join(f"line {n} of its log" for n in range(40))


def engine(name, rung, summary, bias=None, version="neph 0.1.0", device="CPU, 2 threads",
           missing="", install_line=""):
    return {"name": name, "summary": summary, "rung": rung, "bias": bias, "available": not missing,
            "version": "" if missing else version,
            "device": "" if missing else device, "missing": missing, "install_line": install_line}


ENGINES = [engine("exact", "exact", "closed forms and converged quadrature in double precision"),
           engine("tracer", "tracer", "unbiased path tracer of participating media",
                  device="llvmpipe (LLVM 15.0.6, 256 bits)"),
           engine("march", "model", "ray marcher at full resolution with fine steps",
                  bias="single scattering; step error of order 2",
                  device="llvmpipe (LLVM 15.0.6, 256 bits)"),
           engine("realtime", "model", "four-frame pipeline with temporal reuse",
                  bias="history lags by up to 4 frames", device="llvmpipe (LLVM 15.0.6, 256 bits)"),
           engine("cycles", "witness", "Blender Cycles",
                  bias="heterogeneous media are biased by the step rate", version="Blender 3.4.1"),
           engine("povray", "witness", "POV-Ray media", bias="single scattering only",
                  missing="the command povray is not on the path",
                  install_line="sudo apt-get install povray"),]


def measurements(error, sign, radiance=True):
    """A full set of numbers around one relative error."""
    rows = []
    for mask, pixels, worse in (("all", 20736, 1.0), ("sky", 9216, 0.4), ("medium", 11520, 1.3),
                                ("depth_edge", 612, 3.1)):
        for quantity, unit, size in (("radiance", UNIT, 3.7), ("transmittance", "1", 0.6),
                                     ("depth", "m", 140.0)):
            if quantity == "radiance" and not radiance:
                continue
            rms = error * worse * size
            values = [("bias", unit, sign * rms * 0.31),
                      ("rel_bias", "1", sign * error * worse * 0.31), ("rmse", unit, rms),
                      ("rel_rmse", "1", error * worse),
                      ("rel_mse", "1", (error * worse) ** 2), ("max_abs", unit, rms * 7.3),
                      ("p50", unit, rms * 0.45), ("p95", unit, rms * 2.1), ("p99", unit, rms * 3.4),
                      ("non_finite", "px", 0), ("negative", "px", 0)]
            if quantity == "depth":
                values = values[2:3] + values[4:5]
            for metric, its_unit, value in values:
                interval = ([value * 0.93, value * 1.08] if quantity == "radiance"
                            and metric in ("bias", "rmse", "rel_mse") else None)
                rows.append({"quantity": quantity, "metric": metric, "mask": mask, "value": value,
                             "unit": its_unit, "interval": sorted(interval) if interval else None,
                             "pixel_count": pixels})
    return rows


def frame(scene, name, error=None, sign=1, status="rendered", reason="", truth=False, seconds=1.0,
          settings="", reused=False, transmittance=True):
    rendered = status == "rendered"
    base = f"images/{scene}/{name}"
    compared = rendered and not truth
    return {"engine": name, "rung": next(e["rung"] for e in ENGINES if e["name"] == name),
            "status": status, "reason": reason, "settings": settings,
            "reused": reused, "render_s": seconds if rendered else None,
            "wall_s": seconds * 1.13 + 0.4 if status not in ("cannot", "missing") else None,
            "cpu_s": seconds * 1.9 if rendered else None, "peak_memory_bytes": 187_400_192
            if rendered else None, "picture": f"{base}.png" if rendered else None,
            "difference": {"radiance": f"{base}_difference_radiance.png" if compared else None,
                           "transmittance": f"{base}_difference_transmittance.png" if compared
                           and transmittance else None},
            "measurements": measurements(error, sign) if compared and error is not None else []}


def gate(name, metric, value, maximum, quantity="radiance", mask="all", verdict=None,
         reason="limit of the scene file"):
    verdict = verdict or ("not_measured" if value is None else "pass"
                          if abs(value) <= maximum else "fail")
    return {"engine": name, "quantity": quantity, "metric": metric, "mask": mask, "value": value,
            "maximum": maximum, "verdict": verdict, "reason": reason}


def find(frames, name, quantity, metric, mask="all"):
    rows = next(f for f in frames if f["engine"] == name)["measurements"]
    return next(r["value"] for r in rows if (r["quantity"], r["metric"],
                                             r["mask"]) == (quantity, metric, mask))


RANKED = (("radiance", "rel_rmse"), ("transmittance", "rmse"), ("depth", "rel_rmse"))


def ranking_number(item):
    """The measurement that ranks a frame, or None."""
    for quantity, metric in RANKED:
        for row in item["measurements"]:
            if (row["quantity"], row["metric"], row["mask"]) == (quantity, metric, "all") \
                    and row["value"] is not None:
                return row
    return None


def ranked(scenes):
    """The order of the C program for all compared frames: failed gates first, then the largest
    error."""
    rows = []
    for scene in scenes:
        for item in scene["frames"]:
            found = ranking_number(item)
            if not scene["truth"] or item["engine"] == scene["truth"]["engine"] or not found:
                continue
            failing = any(g["engine"] == item["engine"] and g["verdict"] == "fail"
                          for g in scene["gates"])
            rows.append({"scene": scene["name"], "engine": item["engine"],
                         **{key: found[key] for key in ("quantity", "metric", "mask", "value",
                                                        "unit")}, "failing": failing,
                         "cause": f"Where: in {scene['name']}. Why: {item['engine']} {HOSTILE}.",
                         "parts": {"noise": None, "offset": 0.1, "edges": 0.5,
                                   "edge_pixels": 0.25}})
    return sorted(rows, key=lambda row: (not row["failing"], -row["value"]))


def study(option, chosen, certain, noise):
    """A step study that converges with its order, down to `noise`."""
    levels = [{"setting": 25.0 * 2 ** k, "radiance": 0.2926 * (1 + 0.027 / 4 ** k),
               "noise": noise * 0.29, "bias": 0.027 / 4 ** k,
               "bias_noise": noise, "wall_s": 1.5 * 1.4 ** k} for k in range(4)]
    return {"option": option, "order": 2.0, "observed_order": None if noise else 1.98,
            "limit": 0.2926, "size_px": [32, 18], "levels": levels,
            "chosen": chosen, "verdict": "within" if certain else "noise", "tolerance": 1e-3}


def pair(first, second, mean, width, verdict, noise=0.003):
    return {"first": first, "second": second, "mean_difference": mean,
            "interval": [mean - width, mean + width], "rms_difference": abs(mean) * 1.3,
            "noise_floor": noise, "verdict": verdict}


ATTRIBUTION = {"mask": "medium", "pixel_count": 11520, "family_alpha": 0.01, "mean_meant": 1e-3,
               "rms_meant": 1e-2, "odd_one_out": "realtime", "sentence": "realtime is the odd one "
               "out: it differs from all others, and they do not differ beyond noise",
               "pairs": [pair("exact", "march", -2e-4, 1e-5, "agree", 0),
                         pair("exact", "realtime", 0.021, 0.0008, "differ"),
                         pair("exact", "cycles", -8e-4, 0.0031, "cannot tell: noise"),
                         pair("march", "realtime", 0.0212, 0.0008, "differ"),
                         pair("march", "cycles", -6e-4, 0.0031, "cannot tell: noise"),
                         pair("realtime", "cycles", -0.022, 0.0032, "differ")],}
SILENT = {"mask": "all", "pixel_count": 20736,
          "pairs": [pair("tracer", "march", 1e-4, 0.01, "cannot tell: noise")], "odd_one_out": None,
          "sentence": f"cannot tell: noise hides whether all agree {HOSTILE}"}


def finding(check, name, deviation=None, error=None, status="rendered", reason="", cause=None,
            views=1, participant=None, **more):
    """A row of the physics suite; a deterministic engine has a step bound."""
    chance = name in ("tracer", "cycles")
    width = None if deviation is None else (3.6 * error if chance else error) + 1e-6
    verdict = ("not_measured" if deviation is None else "agrees"
               if abs(deviation) <= width else "off")
    who = participant or name
    there = deviation is not None
    path = "images/physics/" + check["name"] + "/" + "".join(c if c.isalnum() else "_" for c in who)
    return {"check": check["name"], "rung": check["rung"], "participant": who, "engine": name,
            "status": status, "reason": reason, "settings": "samples=256" if chance else "",
            "lowered": False, "look": False, "deviation": deviation,
            "interval": [deviation - width, deviation + width] if there else None,
            "standard_error": error if chance else None, "step_bound": None if chance else error,
            "rounding": 1e-6, "z": deviation / error if there and chance else None,
            "pixel_z_mean": -0.03 if name == "tracer" and there else None,
            "pixel_z_variance": 1.04 if name == "tracer" and there else None, "verdict": verdict,
            "cause": cause, "sentence": "" if not there else f"{who} {verdict}", "wall_s": 0.31,
            "pictures": [f"{path}_{v}.png" for v in range(views if there else 0)],
            "differences": [f"{path}_{v}_difference.png" for v in range(views if there else 0)],
            **more}


def physics_check(name, rung, what, views=1):
    return {"name": name, "rung": rung, "what": what,
            "views": [{"what": f"camera looks {50 + v}° down", "size_px": [24, 16],
                       "exposure_ev": -0.5, "difference_scale": 0.1,
                       "picture": f"images/physics/{name}/truth_{v}.png"} for v in range(views)]}


def physics_data():
    furnace, slab, budget = checks = [
        physics_check("furnace_box_4", "furnace", "a homogeneous cube: optical depth 4, albedo 1, "
                      "isotropic scattering; lit evenly from all sides; seen from above"),
        physics_check("slab_iso_4", "slab",
                      "a homogeneous slab, endless sideways, black below: optical depth 4"),
        physics_check("hostile_5", "of tomorrow", f"a rung that the page does not know {HOSTILE}",
                      views=4)]
    rows = [
        finding(furnace, "exact", 0.0, 0.0), finding(furnace, "tracer", -2e-6, 1e-5),
        finding(furnace, "march", -0.522, 0.0, cause="it models single scattering only",
                lowered=True),
        finding(furnace, "march", 0.34, 0.001, participant="march octaves", look=True,
                cause="a sum of octaves is a non-physical model: it does not conserve energy"),
        finding(furnace, "povray", status="missing",
                reason="the command povray is not on the path"),
        finding(slab, "exact", status="cannot", reason="cannot: multiple scattering"),
        finding(slab, "tracer", 0.0008, 0.0005),
        finding(slab, "cycles", 0.0021, 0.0001, cause="it marches through uneven media in steps",
                bake={"grid": [64, 64, 64], "mean_error": 2.4e-4, "kind": HOSTILE, "exact": False,
                      "worst": None}), finding(slab, "march", 0.04, 0.001),
        finding(slab, "realtime", status="timeout", reason="stopped after 300 s"),
        finding(budget, "tracer", 0.001, 0.0006, views=4),
        finding(budget, "march", -0.9, 0.2, views=4, cause=HOSTILE)]
    tests = sum(row["deviation"] is not None for row in rows)
    # A row of an older or newer program: optional fields are missing, unknown fields are present.
    del rows[1]["look"]
    rows[1]["unheard_of"] = {"of": "by this page"}
    return {"family_alpha": 0.01, "tests": tests, "critical_z": 3.37, "verdict": "fail",
            "seconds": 13.5,
            "rungs": [{"name": "furnace", "title": "albedo 1 in a uniform surround vanishes"},
                      {"name": "single", "title": "not in this run"},
                      {"name": "slab", "title": "slab, all orders, against adding-doubling"},
                      {"name": "of tomorrow", "title": HOSTILE}],
            "phase_functions": [{"phase": HOSTILE, "g": 0.85, "integral": 1.0000000000000004,
                                 "mean_cosine": 0.8500000000000002, "sampled_mean_cosine": -3.4e-18,
                                 "verdict": "off"}], "checks": checks, "rows": rows}


def chart_spec():
    spec = json.loads((PAGE / "speed_accuracy.vl.json").read_text())
    rows = []

    def series(name, engine_name, labels, seconds, error, slower, better):
        for k, label in enumerate(labels):
            s, e = seconds * slower ** k, error * better ** k + 2e-5
            rows.append({"series": name, "engine": engine_name, "label": label, "seconds": s,
                         "seconds_low": s * 0.93, "seconds_high": s * 1.12,
                         "error": e, "error_low": e * 0.8 if k < 4 else -1e-6,
                         "error_high": e * 1.25, "unit": "relative RMSE"})

    series("march: steps", "march", [f"steps={2 ** k}" for k in range(3, 9)], 0.012, 0.08, 1.9,
           0.26)
    series("realtime: preset", "realtime", ["low", "medium", "high", "ultra"], 0.004, 0.05, 1.7,
           0.6)
    series("tracer: samples", "tracer", [f"samples={4 ** k}" for k in range(1, 6)], 0.2, 0.05, 3.9,
           0.5)
    series("cycles: step rate", "cycles", ["rate=4", "rate=2", "rate=1", "rate=0.5"], 1.1, 0.03,
           1.8, 0.5)
    rows.append({"series": HOSTILE, "engine": "povray", "label": HOSTILE[:14], "seconds": 2.1,
                 "seconds_low": None, "seconds_high": None,
                 "error": 0.2, "error_low": None, "error_high": None, "unit": "relative RMSE"})
    rows.append({"series": "march: steps", "engine": "march", "label": "not measured",
                 "seconds": None, "seconds_low": None, "seconds_high": None,
                 "error": None, "error_low": None, "error_high": None, "unit": "relative RMSE"})
    spec["datasets"]["points"] = rows
    spec["datasets"]["slopes"] = [
        {"line": "order 2 in time", "seconds": 0.014, "error": 0.04},
        {"line": "order 2 in time", "seconds": 0.28, "error": 0.0001},
        {"line": "order ½ (Monte Carlo)", "seconds": 0.2, "error": 0.035},
        {"line": "order ½ (Monte Carlo)", "seconds": 45, "error": 0.035 / 15}]
    return spec


def flicker_row(preset, seen, floor):
    """A preset over time; `floor` None: not measured."""
    measurement = {"quantity": "radiance", "metric": "seen_contrast", "mask": "all", "value": seen,
                   "unit": "1", "interval": None, "against_centre_rays": seen * 1.01}
    if floor is not None:
        measurement.update(floor=floor, times_floor=seen / floor)
    return {"engine": "realtime", "preset": preset, "settings": "steps=8", "status": "rendered",
            "reason": "", "render_s": 1.5, "speed": None, "measurements": [measurement],
            "floors": [] if floor is None else ["off+taa=on", "off+taa=on+taa_jitter_length=8"],
            "findings": [{"mask": "all", "text": f"flicker of {preset} {HOSTILE}"}],
            "pictures": [], "map": None}


def sequence(scene, rows):
    return {"scene": scene, "title": f"Clouds behind bars {HOSTILE}", "physics": "A drift.",
            "size_px": [WIDTH, HEIGHT], "frames": 16, "rate_hz": 30, "exposure_ev": 0.5,
            "reference": {"engine": "march", "settings": "steps=8", "text": "march, 16 rays",
                          "status": "rendered", "reason": "", "cpu_s": 12.5}, "rows": rows}


def report_data():
    fog = [frame("height_fog", "exact", truth=True, seconds=0.8, settings="nodes=64"),
           frame("height_fog", "tracer", 0.0042, 1, seconds=41.7, settings="samples=1024, seed=1"),
           frame("height_fog", "march", 0.00071, -1, seconds=0.212, settings="steps=256"),
           frame("height_fog", "realtime", 0.0088, -1, seconds=0.0134, settings="preset=high"),
           frame("height_fog", "cycles", 0.0119, 1, seconds=12.8,
                 settings="samples=256, step_rate=0.5", reused=True, transmittance=False),
           frame("height_fog", "povray", status="missing",
                 reason="the command povray is not on the path")]
    bank = [frame("cloud_bank", "exact", status="cannot",
                  reason="cannot: multiple scattering in a heterogeneous medium"),
            frame("cloud_bank", "tracer", truth=True, seconds=388.0,
                  settings="samples=8192, seeds 1 and 2"),
            frame("cloud_bank", "march", 0.031, -1, seconds=0.64, settings="steps=512"),
            frame("cloud_bank", "realtime", 0.094, -1, seconds=0.0161, settings="preset=high"),
            frame("cloud_bank", "cycles", status="timeout", reason="stopped after 600 s",
                  seconds=531.0), frame("cloud_bank", "povray", status="missing",
                                        reason="the command povray is not on the path")]
    odd = [frame("odd", "march", 0.5, 1, settings=HOSTILE),
           frame("odd", "realtime", status="failed", reason=LOG),
           frame("odd", "cycles", status="interrupted", reason=HOSTILE_SCRIPT),
           frame("odd", "povray", status="over_budget", reason="did not fit into 30 s: by a frame "
                 "of 4x3 px its radiance would take 96 s")]
    # A frame of an engine without image and cost, with measures without value.
    odd[0].update({"picture": None, "difference": {"radiance": None, "transmittance": None},
                   "render_s": None, "wall_s": None, "cpu_s": None, "peak_memory_bytes": None})
    for row in odd[0]["measurements"]:
        row["value"] = row["interval"] = None
        row["undefined_because"] = f"no pixel of the mask is solid {HOSTILE}"
    odd[0]["measurements"][2].update({"value": 1.5e-13, "unit": HOSTILE})
    odd[0]["measurements"].append({"quantity": "radiance", "metric": "flip_" + HOSTILE,
                                   "mask": "wire " + HOSTILE, "value": 123456789.5, "unit": "1",
                                   "interval": [0, 999.96], "pixel_count": 3})
    fog[4]["study"] = study("step", 1, False, 0.0017)
    fog[2]["study"] = study("steps", 3, True, 0.0)
    fog[2]["speed"] = {"start_s": 0.31, "render_s": 0.0113, "low_s": 0.0109, "high_s": 0.0121,
                       "repeats": 48, "interval": "10 % to 90 % of the frames"}
    fog[4]["noise"] = {"value": 0.0119, "unit": "1", "text": "noise left in a pixel: 1.2 %"}
    fog[4]["bake"] = {"voxels": 262144,
                      "largest_error": {"radiance": 0.0021, "transmittance": 3e-5}}
    scene = {"difference_scale": {"radiance": 0.25, "transmittance": 0.05}}
    data = {"format": "neph-report-1", "title": "Nightly of main, all scenes",
            "created_utc": "2026-11-21T02:00:00Z", "neph_version": "0.1.0 (079f69e)",
            "host": {"cpu": "AMD EPYC 7763 64-Core Processor", "cores": 2,
                     "memory_bytes": 8_342_462_464}, "size_px": [WIDTH, HEIGHT],
            "verdict": "fail", "counts": {"expected": 28, "reported": 28, "compared": 9},
            "seconds": 1013.4, "engines": copy.deepcopy(ENGINES), "scenes": [
        {"name": "height_fog", "title": "Height fog under a low sun", "exposure_ev": -1.5,
         "hash": "5f1c9d0e77ab34c2a1907733e2d94b58", **scene,
         "physics": "Extinction falls off exponentially with height; single scattering of a "
         "Henyey-Greenstein phase function (g = 0.6). "
         "Isolates the path integral of an inhomogeneous medium, which has a closed form for "
         "transmittance.", "truth": {"engine": "exact", "rung": "exact"}, "frames": fog,
         "viewer": "view/height_fog/index.html",
         "attribution": copy.deepcopy(ATTRIBUTION),
         "gates": [gate("march", "rel_mse", find(fog, "march", "radiance", "rel_mse"), 1e-4),
                   gate("march", "max_abs", find(fog, "march", "transmittance", "max_abs"), 0.01,
                        "transmittance"),
                   gate("realtime", "max_abs",
                        find(fog, "realtime", "transmittance", "max_abs"), 0.0625,
                        "transmittance"),
                   gate("tracer", "rel_bias", find(fog, "tracer", "radiance", "rel_bias"), 0.005,
                        reason="three standard errors of 1024 samples"),
                   gate("cycles", "rel_bias", find(fog, "cycles", "radiance", "rel_bias"), 0.02,
                        reason="known bias of the step rate")]},
        {"name": "cloud_bank", "title": "A bank of cloud, all orders of scattering",
         "exposure_ev": 0.5, "hash": "0b77e0cc1f5d4b7f9b2e6a10c4d8e3aa", **scene,
         "physics": "A heterogeneous cloud of albedo 0.999 with all orders of scattering. Isolates "
         "what a single-scattering model leaves out.",
         "truth": {"engine": "tracer", "rung": "tracer"}, "frames": bank,
         "attribution": copy.deepcopy(SILENT),
         "gates": [gate("march", "rel_mse", find(bank, "march", "radiance", "rel_mse"), 0.004),
                   gate("realtime", "rel_mse", find(bank, "realtime", "radiance", "rel_mse"), 0.004,
                        reason="model gap, agreed in the scene file"),
                   gate("cycles", "rel_bias", None, 0.02, reason="the rendering timed out")]},
        {"name": "odd", "title": f"Hostile {HOSTILE}", "exposure_ev": None, "hash": HOSTILE,
         "difference_scale": {"radiance": 1, "transmittance": 1},
         "physics": f"Strings that must stay text: {HOSTILE} {HOSTILE_SCRIPT} &amp; “quotes” '\"",
         "truth": None, "frames": odd, "attribution": None,
         "gates": [gate("march", "rmse", None, 0.1, mask=HOSTILE, reason=HOSTILE)]},],
            "metrics": [{"name": name, "help": f"what {name} is {HOSTILE}"}
                        for name in ("rel_mse", "p95", "not_measured_here")],
            "sequences": [sequence("fence", [flicker_row("seed", 3.7334, 4.3549),
                                             flicker_row("ours", 5.2838, 0.8125)]),
                          sequence("railings", [flicker_row("fixed", 2.5, None)])],
            "absent": [{"scene": "disney_cloud", "reason": f"no file cloud.vdb {HOSTILE}",
                        "hint": "see scenes/README.md"}], "physics": physics_data(), "charts": [
        {"id": "speed_accuracy", "title": "What accuracy costs",
         "caption": "Error against render time in the height fog. Each line halves or doubles one "
         "setting; dashed lines are ideal rates of convergence.",
         "svg": "charts/speed_accuracy.svg", "missing": None, "spec": chart_spec()},
        {"id": "no_svg", "title": f"A chart without a static picture {HOSTILE}", "caption": HOSTILE,
         "svg": None, "missing": "node is not installed",
         "spec": {"$schema": "https://vega.github.io/schema/vega-lite/v6.json",
                  "background": "white", "width": 300, "height": 120,
                  "data": {"values": [{"name": HOSTILE, "ms": 3}, {"name": "b", "ms": 5}]},
                  "mark": {"type": "bar", "color": "#0072B2"},
                  "encoding": {"x": {"field": "ms", "type": "quantitative"},
                               "y": {"field": "name", "type": "nominal", "title": None}}}},],}
    data["ranking"] = ranked(data["scenes"])
    return data


# --------------------------------------------------------------------------------------- layout

def build(folder, data=None):
    """Lay a report out as the C program does."""
    data = data or report_data()
    lay_out(folder, "report", "NEPH_REPORT", data)
    (folder / "vendor").mkdir(exist_ok=True)
    for name, source in VENDORED.items():
        shutil.copy(PAGE / source, folder / "vendor" / name)
    gains = {"exact": (0, 0), "tracer": (0, 0), "march": (0.15, 2), "realtime": (0.4, 2),
             "cycles": (-0.2, 2)}
    for scene in data["scenes"]:
        for item in scene["frames"]:
            shift, gain = gains.get(item["engine"], (0, 0))
            if item["picture"]:
                write_png(folder / item["picture"], picture(shift))
            for kind, scaling in (("radiance", 1), ("transmittance", -0.6)):
                if item["difference"][kind]:
                    write_png(folder / item["difference"][kind], difference(shift, scaling * gain))
        if scene.get("viewer"):
            (folder / scene["viewer"]).parent.mkdir(parents=True, exist_ok=True)
            (folder / scene["viewer"]).write_text("<!DOCTYPE html>")
    physics = data.get("physics") or {"checks": [], "rows": []}
    for path in [view["picture"] for check in physics["checks"] for view in check["views"]] + [
        path for row in physics["rows"] for path in row["pictures"]]:
        write_png(folder / path, lambda i, j: (9 * i, 9 * i, 16 * j), 24, 16)
    for path in [path for row in physics["rows"] for path in row["differences"]]:
        write_png(folder / path, lambda i, j: STOPS[(i + j) % 5], 24, 16)
    (folder / "charts").mkdir(exist_ok=True)
    for chart in data["charts"]:
        if chart["svg"]:
            spec = folder / "charts" / f"{chart['id']}.vl.json"
            spec.write_text(json.dumps(chart["spec"]))
            drawn = node(PAGE / "render_chart.mjs", spec, folder / chart["svg"])
            if drawn.returncode != 0:
                raise RuntimeError(drawn.stderr)


# ---------------------------------------------------------------------------------------- tests

class Charts(unittest.TestCase):
    """render_chart.mjs, which needs no browser."""

    def draw(self, change):
        spec = chart_spec()
        change(spec)
        with tempfile.TemporaryDirectory() as folder:
            source, target = pathlib.Path(folder, "spec.json"), pathlib.Path(folder, "out.svg")
            source.write_text(json.dumps(spec))
            result = node(PAGE / "render_chart.mjs", source, target)
            left = sorted(p.name for p in pathlib.Path(folder).iterdir())
            return result, target.read_text() if target.exists() else None, left

    def test_the_chart_fits_a_readme_and_brings_its_own_paper(self):
        result, svg, _ = self.draw(lambda spec: None)
        self.assertEqual(svg, self.draw(lambda spec: None)[1])  # only the data determine the bytes
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        self.assertLessEqual(int(svg.split('width="')[1].split('"')[0]), 760)
        self.assertIn('fill="white"', svg)
        for text in ("march: steps", "order 2 in time", "steps=8",
                     "error against the truth [relative RMSE]"):
            self.assertIn(text, svg)
        self.assertIn("&lt;img src=x", svg)
        self.assertNotIn("<img", svg)

    def test_a_chart_needs_neither_slopes_nor_error_bars(self):
        def bare(spec):
            spec["datasets"]["slopes"] = []
            spec["datasets"]["points"] = [{**row, "seconds_low": None, "seconds_high": None,
                                           "error_low": None, "error_high": None}
                                          for row in spec["datasets"]["points"]]
        result, svg, _ = self.draw(bare)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("steps=8", svg)

    def test_no_rows_is_an_error_and_leaves_no_file(self):
        result, svg, left = self.draw(lambda spec: spec["datasets"].update(points=[], slopes=[]))
        self.assertEqual(result.returncode, 1)
        self.assertIn("nothing to draw", result.stderr)
        self.assertIsNone(svg)
        self.assertEqual(left, ["spec.json"])

    def test_data_from_outside_are_refused(self):
        result, svg, _ = self.draw(
            lambda spec: spec["layer"][0].update(data={"url": "https://example.com/rows.json"}))
        self.assertEqual(result.returncode, 1)
        self.assertIn("example.com", result.stderr)
        self.assertIsNone(svg)

    def test_broken_files_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "broken.json")
            source.write_text("{")
            result = node(PAGE / "render_chart.mjs", source, pathlib.Path(folder, "out.svg"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("broken.json", result.stderr)
        self.assertEqual(node(PAGE / "render_chart.mjs").returncode, 2)

    def test_the_licence_texts_are_those_of_the_installed_packages(self):
        result = node(PAGE / "vendor_licences.mjs")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout, (PAGE / "vendor-licences.txt").read_text(),
                         "run `npm run --silent licences` in scripts/report")


class Page(PageCase):
    """The page in headless Chromium."""
    NAME = "report"
    build = staticmethod(build)

    def broken(self, name, change, how="--quick"):
        """A copy of the good report with one fault."""
        folder = self.folder(name)
        shutil.copytree(self.good, folder)
        change(folder)
        return self.check(folder, how)

    def test_a_good_report_has_no_faults(self):
        self.assert_page_is_good(self.good)

    def test_a_small_bias_does_not_hide_the_worst_engine(self):
        """An engine with a bias of -0.5 % and an RMSE of 70 % was once called "all agree", below
        others with a larger bias."""
        data = report_data()
        bank = data["scenes"][1]
        for row in next(f for f in bank["frames"] if f["engine"] == "march")["measurements"]:
            if (row["quantity"], row["mask"]) == ("radiance", "all"):
                row["value"] = {"rel_bias": -0.005, "rel_rmse": 0.7}.get(row["metric"],
                                                                         row["value"])
        data["ranking"] = ranked(data["scenes"])
        folder = self.built("small_bias", data)
        self.assert_page_is_good(folder, "--quick")
        # A page that ranks by the bias names another engine.
        script = folder / "report.js"
        text = script.read_text()
        wrong = text.replace('["radiance", "rel_rmse", "all"],', '["radiance", "rel_bias", "all"],')
        self.assertNotEqual(text, wrong)
        script.write_text(wrong)
        self.assert_finds(self.check(folder, "--quick"), (
            ("the worst engine", "the verdict does not name the worst: march"),
            ("the order of the heat map", "the heat map is not sorted by RMSE"),))

    def test_a_report_of_nothing_still_reads(self):
        data = report_data()
        del data["physics"]
        data.update(scenes=[], ranking=[], charts=[], engines=[],
                    counts={"expected": 0, "reported": 0, "compared": 0},
                    host={"cpu": None, "cores": None, "memory_bytes": None}, seconds=None)
        self.assert_page_is_good(self.built("empty", data), "--quick")

    @night.of_the_night
    def test_physics_only_and_static_charts(self):
        folder = self.folder("static")
        shutil.copytree(self.good, folder)
        shutil.rmtree(folder / "vendor")
        data = report_data()
        rows = len(data["physics"]["rows"])
        data.update(scenes=[], ranking=[], interactive=False,
                    counts={"expected": rows, "reported": rows, "compared": 5})
        write_data(folder, "NEPH_REPORT", data)
        self.assert_page_is_good(folder, "--quick")

    def changed_data(self, name, change):
        """Data that are inconsistent, whatever a page displays."""
        def rewrite(folder):
            data = report_data()
            change(data)
            write_data(folder, "NEPH_REPORT", data)
        result = self.broken(name, rewrite, "--data")
        self.assertEqual(result.returncode, 1)
        return result.stdout

    def test_an_interval_that_contradicts_its_verdict_is_found(self):
        found = self.changed_data(
            "interval", lambda data: data["physics"]["rows"][8].update(interval=[-0.01, 0.09]))
        self.assertIn("physics/rows/8/interval does not go with the verdict off", found)

    def test_a_truth_that_is_off_cannot_pass(self):
        def change(data):
            data["physics"]["rows"] = [row for row in data["physics"]["rows"]
                                       if row["status"] != "timeout"]
            data["scenes"] = data["ranking"] = []
            data["verdict"] = "pass"
            row = data["physics"]["rows"][1]
            row.update(deviation=0.1, interval=[0.09, 0.11], verdict="off")
        self.assertIn("verdict is pass though tracer is off",
                      self.changed_data("false_pass", change))

    def test_a_ranking_out_of_order_is_found(self):
        found = self.changed_data("ranking", lambda data: data["ranking"].reverse())
        self.assertIn("is larger than the one before it", found)

    def test_a_lost_frame_is_found(self):
        self.assertIn("counts/reported is",
                      self.changed_data("lost", lambda data: data["scenes"][0]["frames"].pop()))

    def test_nothing_compared_cannot_pass(self):
        def change(data):
            data.update(scenes=[], ranking=[], physics=None, verdict="pass",
                        counts={"expected": 0, "reported": 0, "compared": 0})
        self.assertIn("nothing was compared", self.changed_data("nothing_compared", change))

    def test_a_wrong_odd_one_out_is_found(self):
        found = self.changed_data(
            "odd",
            lambda data: data["scenes"][0]["attribution"]["pairs"][1].update(verdict="agree"))
        self.assertIn("does not differ from all others", found)

    def test_each_of_several_faults_is_found(self):
        """Independent faults in one page: one browser for each would take most of the time."""
        folder = self.copy_with((
            ("const drawn = own.filter((row) => inside(row.pictures?.[v]));",
             "const drawn = own.filter((row) => inside(row.pictures?.[v])"
             ' && row.participant !== "tracer");'),
            ('row.lowered || row.look ? "gap"', 'row.lowered ? "gap"'),
            ("viewer && [", "null && ["),
            ('region.scrollWidth > region.clientWidth + 1);', "false);"),
            ('.filter((row) => typeof row.value === "number").map((row) => ({ frame, row })));',
             ".map((row) => ({ frame, row })));"),
            (' && typeof row.value === "number");\n\n  function', ");\n\n  function"),
            ('gate.engine === frame.engine && gate.quantity === "radiance"));', "false));"),
            ("path && legend(scene, kind)));", "null));"),
            ('el("p", {}, scene.physics)', 'Object.assign(el("p"), { innerHTML: scene.physics })'),
            ("const shown = value * scale;", "const shown = value * scale * "
             '(path === "scenes/1/frames/1/wall_s" ? 1.02 : 1);')))
        page = folder / "index.html"
        text = page.read_text()
        start = text.index('<meta http-equiv="Content-Security-Policy"')
        text = text[:start] + text[text.index(">", start) + 1:]
        page.write_text(text.replace(
            "</head>", '<script src="https://example.com/tracker.js"></script></head>'))
        data = report_data()
        data["scenes"][0]["frames"][1]["measurements"][2]["value"] *= 1.001
        data["sequences"][0]["rows"][1]["measurements"][0]["floor"] *= 1.001
        (folder / "data.json").write_text(json.dumps(data))
        (folder / "images/height_fog/march.png").unlink()
        (folder / "vendor/vega.min.js").unlink()
        self.assert_finds(self.check(folder, "--quick"), (
            ("a hidden picture of a check", "images/physics/furnace_box_4/tracer_0.png"),
            ("a finding that is counted wrongly", "physics.others.gap"),
            ("a viewer without a link", "no link leads to the viewer"),
            ("a table wider than the window", "wider than its place"),
            ("a row without a number", "a row without a number"),
            ("a wrong count of what is not gated", "frames.ungated"),
            ("a map without a scale", "a map without its scale"),
            ("a number that differs", "scenes/0/frames/1/measurements/2/value"),
            ("a floor that differs", "sequences/0/rows/1/measurements/0/floor"),
            ("a number shown wrongly", "scenes/1/frames/1/wall_s: the page reads"),
            ("a missing picture", "images/height_fog/march.png"),
            ("a missing bundle", "vendor/vega.min.js"),
            ("a network request", "example.com"),
            ("markup from data", "markup that is none of the page's")))


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--fixture":
        build(pathlib.Path(sys.argv[2]))
    else:
        unittest.main(verbosity=2)
