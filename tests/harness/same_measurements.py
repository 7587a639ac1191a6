#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs a fixed list of commands with two builds of neph and compares all their output exactly:
text, exit codes and all files. For changes of the program that must not change a measurement. Run
by hand; e2e_same_measurements.py tests the comparison."""
import argparse
import csv
import fnmatch
import io
import json
import os
import pathlib
import re
import shlex
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time

# ---- commands ------------------------------------------------------------------------------------

# CASE | LIST | ARGUMENTS of neph. The commands of a case run in order, in a folder of the case; its
# files are compared after the last one. LIST is `quick` (also in the full list) or `full`, and is
# equal in all lines of a case, so that a record of the full list serves both. `first` is the first
# command of the case that STARTS_WITH names. `--suite failure` is the word for the stress tests
# that earlier programs understand, too. Sizes are the smallest at which the verb still gives all of
# its numbers.
COMMANDS = """
scenes            | quick | scenes
scenes            | quick | scenes --json
scenes            | quick | scenes two_layer_fog
scenes            | quick | scenes fog_look_ridge
scenes            | quick | scenes cloud_below --json
scenes            | quick | scenes fence_pitch4 --variant sun_step
scenes            | quick | scenes voxel_grid --variant sun_sine --frames 64
scenes            | quick | scenes voxel_grid --variant camera_cut
scenes            | quick | engines
scenes            | quick | engines --json
scenes            | quick | engines realtime
scenes            | quick | metrics
scenes            | quick | metrics --json
scenes            | quick | metrics --masks
scenes            | quick | metrics flip
scenes            | quick | post --list
scenes            | quick | ablate --list
scenes            | quick | ablate --list --preset ue
scenes            | quick | nightly --list
scenes            | quick | nightly --list --tier full
scenes            | quick | doctor
scenes            | quick | doctor --json
frames            | quick | render fence_pitch4 -e march --size 48x27 --stats --scene-layers -q -o \
            reference
frames            | quick | render fence_pitch4 -e realtime -p seed --size 48x27 --frames 16 \
            --json --stats --scene-layers -q -o seed
frames            | quick | render fence_pitch4 -e realtime -p ours --size 48x27 --frames 16 -o ours
frames            | quick | render voxel_grid -e tracer -s samples=16 --seed 3 --size 48x27 \
            --checkpoint sums -o tracer
frames            | quick | render voxel_grid -e exact --size 48x27 -o exact
frames            | quick | render voxel_grid -e oracle -s samples=4 --size 16x9 --json -q -o oracle
frames            | quick | compare exact tracer
frames            | quick | compare exact tracer --json -m all --maps maps --csv errors.csv --rings
frames            | quick | compare exact tracer --csv - --fail-above rel_rmse=0.0001
frames            | quick | compare reference/fence_pitch4_march_0000.exr ours --versus seed --json
frames            | quick | compare reference/fence_pitch4_march_0000.exr ours --versus seed
frames            | quick | flicker --reference reference seed --csv flicker.csv --maps flicker_maps
frames            | quick | flicker --reference reference seed --versus ours --json --rings
frames            | quick | flicker --reference reference ours -m all --fps 30 --ppd 30
frames            | quick | post seed -p unreal -s exposure_ev=1 --png -q -o shown
frames            | quick | view exact tracer -o page
frames            | quick | bake gaussian_blob --resolution 12 --json blob.df3
frames            | quick | bake gaussian_blob --resolution 12 blob.vdb
frames more       | full  | render voxel_grid -e cycles -s samples=4 --noise --size 48x27 --json \
            -o cycles
frames more       | full  | render voxel_grid -e povray --size 48x27 --json -o povray
frames more       | full  | export fence_backlit -e povray -o fence_pov
frames more       | full  | export fence_backlit -e cycles -o fence_blend
frames more       | full  | post ours -p unreal -s auto_exposure=on --json --stats -q -o adapted
frames more       | full  | view reference/fence_pitch4_march_0000.exr seed ours --by-position \
            --json -o pages
versus            | full  | render fence_pitch4 -e march --size 24x14 -q -o reference
versus            | full  | render fence_pitch4 -e realtime -p seed --size 24x14 --frames 64 -q -o \
            seed
versus            | full  | render fence_pitch4 -e realtime -p ours --size 24x14 --frames 64 -q -o \
            ours
versus            | full  | compare reference seed --versus ours --json --csv a.csv
versus            | full  | flicker --reference reference seed --versus ours --json --csv b.csv
versus            | full  | flicker --reference reference seed --versus ours
fog catalogue     | quick | validate height_fog_down voxel_grid -e exact -e tracer -e march -e \
            realtime --size 48x27 --json -q
catalogue         | full  | validate --size 48x27 --json --budget 600
physics fast      | quick | validate --suite physics --only single_slab -e \
            exact,oracle,march,tracer --samples 16 --json -q
physics           | full  | validate --suite physics --samples 16 --json
stress            | quick | validate --suite failure --json -q
stress pages      | quick | validate --suite failure --only fog_none --pictures all --preset fixed
study steps       | quick | study steps march height_fog_up --size 16x9 --all
study steps more  | full  | study steps povray height_fog_up --size 16x9 --json
study flicker     | quick | study flicker fence_pitch4 --preset fixed,ours --seeds 1 --frames 16 \
            --size 32x18 --steps 3 --json --csv a.csv --markdown a.md -q
study flicker more | full  | study flicker fence_pitch4 foliage --preset seed,ours --seeds 2 \
            --frames 16 --size 32x18 --steps 3 --all
study light       | quick | study light cloud_below --suns 50:180 --size 12x8 --noise-limit 0.5 \
            --samples 4 --steps 32 --json --csv a.csv --markdown a.md -q
study light more  | full  | study light cloud_below gaussian_blob --laws --fit fit.inc --size 12x8 \
            --noise-limit 0.5 --samples 4 --steps 32 --all
study fog         | quick | study fog fog_look_evening --size 12x8 --directions 64 --json --csv \
            a.csv --markdown a.md
study fog more    | full  | study fog fog_look_ridge --all
study sky         | quick | study sky --size 8x8 --truth oracle --samples 64 --elevations 30 \
            --altitudes 2 --model \
            sky+altitudes=8+suns=24+above=4+below=2+around=3+table_steps=8+orders=4 \
            --json --markdown a.md -q
study sky more    | full  | study sky --size 8x8 --samples 64 --elevations 30,-30 --altitudes 2 \
            --all
study screen      | quick | study screen surface_step --size 24x14 --samples 64 --model \
            screen+gi=off+warm_up=0+ssr_rays=1 --json --markdown a.md -q
study screen more | full  | study screen surface_step surface_rough --size 24x14 --samples 64 \
            --frames 16 --all
study post        | quick | study post railings --size 32x18 --frames 16 --warm-up 4 --steps 4 \
            --only grain --json --csv a.csv --markdown a.md -q
study post more   | full  | study post railings --size 32x18 --frames 16 --warm-up 4 --steps 4 --all
sweep             | quick | sweep voxel_grid --plan plan.yaml --untimed --json --csv a.csv -q
sweep more        | full  | sweep voxel_grid --plan plan.yaml --untimed --only march --seeds 2 --all
sweep more        | full  | sweep voxel_grid --plan sweep --untimed --size 32x18 --only march,ours \
            -o of_neph --all
sweep with times  | full  | sweep voxel_grid --plan plan.yaml --json
ablation          | quick | ablate fence_backlit --only split --size 32x16 --steps 3 --frames 16 \
            --seeds 1 -q --all
ablation more     | full  | ablate fence_backlit foliage --size 32x16 --steps 3 --frames 16 \
            --seeds 1 --json -q
scaling           | full  | scaling voxel_grid --untimed --size 32x18 --json -q
pick              | quick | pick height_fog_level --error 0.01 --size 64x36 --json -q
pick more         | full  | pick voxel_grid --error 0.25 --flicker 4 --size 32x18 --all
pick more         | full  | pick fence_backlit foliage --preset seed,fixed,ours --frames 16 \
            --size 32x18 --steps 3 --least flicker --half-life 8 -o presets --all
benchmark         | quick | benchmark gaussian_blob --resolution 12 -e tracer,oracle --size 16x9 \
            --seconds 0.2 --json -q
benchmark more    | full  | benchmark gaussian_blob --resolution 12 -e tracer,oracle --size 16x9 \
            --seconds 0.2 --all
benchmark passes  | full  | benchmark voxel_grid -e march,realtime --size 32x18 --repeat 8 --json -q
benchmark passes  | full  | benchmark voxel_grid -e march,realtime --size 32x18 --repeat 8 --all
conform           | quick | conform --only height_fog_level -e march --size 32x18 -o a
conform           | quick | conform a a
conform more      | full  | conform --only height_fog_level,voxel_grid --size 32x18 \
            --json -o b
conform more      | full  | conform a b --json
night             | quick | nightly --only fog_none --only height_fog_down --only sweep.voxel_grid \
            --size 32x18 --once
night             | quick | baseline accept --who tester --why looked
night             | quick | nightly --only fog_none --only height_fog_down --only sweep.voxel_grid \
            --size 32x18 --once --json
night             | quick | nightly --only height_fog_down --size 32x18 --once -s march:steps=56
night             | quick | baseline list
night             | quick | store check -o out/nightly
night             | quick | store export -o out/nightly
night more        | full  | nightly --only blob_sky --only cirrus --only slab_above --size 32x18 \
            --json
night more        | full  | store gc -o out/nightly --limit 0 --spare-hours 0
again night       | quick | store check -o out/nightly
again night       | quick | baseline list --json
again night       | quick | nightly --only fog_none --only height_fog_down --only sweep.voxel_grid \
            --size 32x18 --once --json
again night       | quick | store export -o out/nightly
again catalogue   | quick | first
again physics     | quick | first
again stress      | quick | first
again flicker     | quick | first
again light       | quick | first
again sweep       | quick | first
again ablation    | quick | first
again pick        | quick | first
again all         | full  | first
again times       | full  | first
again steps       | quick | first
again sky         | quick | first
again screen      | quick | first
again post        | quick | first
again scaling     | full  | first
stress full       | full  | validate --suite failure --tier full --jobs 2 --json -q
"""

# These cases begin with the folder of another case that the BEFORE program left: they may not
# render any frame that its store has.
STARTS_WITH = {
    "frames more": "frames", "conform more": "conform", "again night": "night",
    "again catalogue": "fog catalogue", "again physics": "physics fast",
    "again stress": "stress", "again flicker": "study flicker", "again light": "study light",
    "again sweep": "sweep", "again ablation": "ablation", "again pick": "pick",
    "again all": "catalogue", "again times": "sweep with times", "again steps": "study steps",
    "again sky": "study sky", "again screen": "study screen", "again post": "study post",
    "again scaling": "scaling"}

# Cases with numbers that depend on the speed of the machine: these numbers are replaced by '#'.
FORM_ONLY = {
    "benchmark": "the machine's speed decides how many samples a rung has",
    "benchmark more": "the machine's speed decides how many samples a rung has",
    "benchmark passes": "all numbers are times, or times divided by counts",
    "sweep with times": "what beats what depends on times"}

# Each verb is called with --help, with an unknown option, and with each of these.
VERBS = ("validate study ablate render fly export bake benchmark sweep scaling pick compare "
         "flicker view post conform metrics nightly baseline store scenes engines doctor").split()
STUDIES = "steps flicker light fog sky screen post".split()
WRONG_WORDS = (
    "", "nonsense", "validate no_such_scene", "validate --suite nonsense", "validate --tier slow",
    "validate -e nonsense", "validate voxel_grid -s march:steps=-3",
    "validate voxel_grid --size 0x0", "validate voxel_grid -o ''",
    "validate --suite failure --only nonsense",
    "validate --suite failure --preset nonsense", "validate --suite physics --only nonsense",
    "study nonsense", "study steps march", "study flicker --suite nonsense",
    "study flicker --takes sign", "study light --model nonsense", "study fog height_fog_up",
    "study fog fog_look_ridge --model unity", "study sky --elevations 91",
    "study sky --truth march", "study screen --model nonsense",
    "study post railings --frames 18", "ablate --suite nonsense",
    "ablate fence_backlit --only nonsense", "ablate slab_multiple_thin", "render",
    "render voxel_grid -e nonsense", "render voxel_grid -s nonsense=1", "render no_such.yaml",
    "render voxel_grid -e realtime -p nonsense", "render voxel_grid --frame 99", "bake voxel_grid",
    "bake voxel_grid -o ''", "benchmark gaussian_blob --error 0.01 --seconds 1",
    "benchmark gaussian_blob -e nonsense", "sweep voxel_grid --plan no_such",
    "sweep voxel_grid --only nonsense", "sweep camera_dolly", "scaling", "pick voxel_grid",
    "pick voxel_grid --error -1", "compare", "compare no.exr such.exr", "flicker no.exr",
    "flicker --reference no.exr such.exr", "view no.exr", "post no.exr", "conform a",
    "conform no such", "metrics nonsense", "nightly --tier slow", "nightly --only nonsense",
    "nightly --executor nonsense", "baseline", "baseline accept", "baseline forget",
    "baseline accept --why x", "store", "store mend", "store gc", "store check",
    "store gc -o out/nightly --limit much", "scenes no_such",
    "scenes voxel_grid --variant nonsense", "engines nonsense", "doctor nonsense",
    "export voxel_grid -e nonsense")

# Input files of commands, written into the folder of each case that names them.
INPUTS = {"plan.yaml": """title: a small one
light: octaves
width_px: 32
height_px: 18
frames: 32
warm_up: 16
truth_samples: 64
rounds: 2
seeds: 2
series:
- {name: march, engine: march, vary: steps, values: 4 16, order: 2}
- {name: ours, engine: realtime, preset: ours, vary: steps, values: 4 16, flicker: true, lag_at: 16}
- {name: fitted, engine: march_octaves_fitted}
"""}

# ---- rules: allowed differences ------------------------------------------------------------------

TIME = "measured time"
SECONDS = r"(?<![\w.])\d+(\.\d+)?(e[-+]?\d+)? ?(s|ms|min|h)\b(?!\^)"
HASH = "hash of bytes that hold measured times; the bytes themselves are compared"

# (case, file, key, why): values of JSON by the path of their keys, columns of CSV and of the
# database by name, text attributes of EXR. A value becomes '<why>'; null stays null, and the key
# stays. stdout is a file, too.
KEY_RULES = (
    ("*", "*", r"(^|\.)(created|started|ended|when|made|begun)_utc$", "date"),
    ("*", "*", r"(^|[._])(render|wall|cpu|gpu|takes|kernel|calibration|tracer)_s(_\w+)?$", TIME),
    ("*", "*", r"(^|[._])(gpu|wall|median|low|high|least)_ms(_\w+)?$", TIME),
    ("*", "*.exr", r"^neph\.stats\.\w+_ms$", TIME),
    ("*", "*", r"(^|\.)(ms|CPU s( of the presets)?)$", TIME),
    ("*", "*", r"(^|\.)seconds(_low|_high)?$", TIME),
    ("*", "*", r"(^|\.)peak_memory_bytes$", "memory in use depends on the time of the look"),
    ("*", "*job.json", r"(^|\.)(frame|record)_blake2b$", HASH),
    ("*", "*job.json", r"(^|\.)results_blake2b\.[\w.]+$", HASH),
    ("*", "*timing.json", r".", TIME),
    ("*", "*", r"^(jobs|evidence)\.(frame|record)_blake2b$", HASH),
    ("*", "*accept-*.json", r"^night_blake2b$", HASH),
    ("*", "*", r"^jobs\.bytes$", "size of a file that holds measured times as text"),
    ("sweep*", "*", r"^load$", "load of the machine"),
    ("again *", "*", r"^load$", "load of the machine"),
    ("benchmark*", "*", r"\.rmse_times\.found$",
     "whether a rung is good enough depends on its samples"),
    ("*", "*", r"(^|\.)host(\.\w+)?$", "machine"),
)

# (case, file, pattern, replacement, why): lines of text, and texts in JSON and in the database.
TEXT_RULES = (
    ("*", "*", r"\b\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", "<date>", "date"),
    ("*", "*", r"\bwork-[0-9a-f]{16}\b", "work-<random>", "name of a temporary folder"),
    ("*", "*.stderr", r" \(about [^()]* left\)$", "", TIME),
    ("[!hw]*", "*.std*", SECONDS, "<time>", TIME),
    ("[!hw]*", "*.log", SECONDS, "<time>", TIME),
    ("*", "*.md", SECONDS, "<time>", TIME),
    ("*night*", "*nightly/report/data.js*", SECONDS, "<time>", TIME),
    ("*night*", "*summary.txt", SECONDS, "<time>", TIME),
    ("*night*", "*junit.xml", r' time="[0-9.e-]+"', ' time="<time>"', TIME),
    ("*", "*.stdout", r"^(\w+_ms) .*", r"\1 <time>", TIME),
    ("*steps*", "*.stdout", r"^( +\d+ .*%) +\d+\.\d\d\b", r"\1 <time>", TIME),
    ("*", "*", r"(\b(?:rendered|reused|cannot|missing|failed)(?: +\S+){3}) +[\d.]+  ",
     r"\1 <time> ", "seconds of an engine in the table of `neph validate`"),
)

# (case, key, value, why): objects of JSON, rows of CSV and of Markdown where KEY is VALUE:
# everything else in them is replaced by '<why>'.
ROW_RULES = (
    ("*ablation", "measure", r"gpu_ms|GPU .*|milliseconds.*", "computed from measured times"),
)

# (case, file, why): for these files only the presence is compared.
PRESENCE_RULES = (
    ("*", "*/blender.log", "another program's progress, with times"),
    ("*", "*/povray-*.log", "another program's messages, with times"),
    ("*", "*.blend", "Blender leaves addresses of its memory in it; spec.json holds its input"),
    ("*", "*/.neph-lock", "lock"),
    ("*", "*/.lock", "lock"),
    ("*post*", "*post.svg", "its last column is measured times; the others are in the JSON"),
    ("sweep with times", "*.svg", "drawn from measured times; the numbers are in data.json"),
    ("*", "*report/charts/*.svg", "drawn from measured times; the numbers are in data.json"),
)

# (file, why): files that are not compared.
LEFT_OUT_RULES = (
    ("*/.cache/thumbnails/*", "Blender names it by a hash of the absolute path of its file"),
)

# ---- comparison ----------------------------------------------------------------------------------


class Number(str):
    """A number as written in a JSON file: 0.1 and 0.10 differ."""


class Rules:
    """The rules for one file of one case, with the folder that paths are shown relative to."""

    def __init__(self, case, name, folder):
        self.form = case in FORM_ONLY
        self.folders = [str(folder)] if folder else []

        def chosen(rules):
            return [rule[2:] for rule in rules
                    if fnmatch.fnmatch(case, rule[0]) and fnmatch.fnmatch(name, rule[1])]
        self.keys = [(re.compile(pattern), why) for pattern, why in chosen(KEY_RULES)]
        self.rows = [(key, re.compile(value), why) for pattern, key, value, why in ROW_RULES
                     if fnmatch.fnmatch(case, pattern)]
        self.texts = [(re.compile(pattern), new) for pattern, new, _ in chosen(TEXT_RULES)]
        self.presence_only = bool(chosen(PRESENCE_RULES))

    def why_key_differs(self, path):
        return next((why for pattern, why in self.keys if pattern.search(path)), None)

    def why_row_differs(self, row):
        """row: {key: value}."""
        return next((why for key, pattern, why in self.rows
                     if isinstance(row.get(key), str) and pattern.fullmatch(row[key])), None)

    def text(self, line):
        for folder in self.folders:
            line = line.replace(folder, "<folder>")
        replaced = line
        for pattern, new in self.texts:
            replaced = pattern.sub(new, replaced)
        if self.form:
            replaced = re.sub(r"[-+]?(\d+\.?\d*(e[-+]?\d+)?|nan|inf|∞)", "#", replaced)
        if replaced != line:  # the width of a column depends on its numbers
            replaced = re.sub(r" +", " ", replaced)
            replaced = re.sub(r"-{4,}", "----", replaced)
        return replaced

    def value(self, path, value):
        why = self.why_key_differs(path)
        if why and value is not None and value != "":
            return f"<{why}>"
        if isinstance(value, Number):
            return "#" if self.form else value
        return self.text(value) if isinstance(value, str) else value


def lines_of_json(document, rules, path=""):
    """(path, value) of each leaf, in the order of the file; empty lists and objects are leaves."""
    if isinstance(document, dict) and rules.why_row_differs(document):
        yield path, f"<{rules.why_row_differs(document)}: {', '.join(document)}>"
    elif isinstance(document, dict) and document:
        for key, value in document.items():
            yield from lines_of_json(value, rules, f"{path}.{key}" if path else key)
    elif isinstance(document, list) and document:
        for place, value in enumerate(document):
            yield from lines_of_json(value, rules, f"{path}[{place}]")
    else:
        bare = re.sub(r"\[\d+\]", "", path)
        yield path, repr(rules.value(bare, document))


def parse_json(text):
    return json.loads(text, parse_float=Number, parse_int=Number, parse_constant=Number)


def read_json(data, rules):
    return list(lines_of_json(parse_json(data.decode()), rules))


def read_script_data(data, rules):
    """window.NAME = {...}; which is JSON except for its frame."""
    head, _, rest = data.decode().partition(" = ")
    return [("name", head)] + list(lines_of_json(parse_json(rest.rstrip().rstrip(";")), rules))


def read_csv(data, rules):
    rows = list(csv.reader(io.StringIO(data.decode())))
    header = rows[0] if rows else []
    entries = [("columns", ",".join(header))]
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(header):
            entries.append((f"line {number}", f"{len(row)} fields"))
        why = rules.why_row_differs(dict(zip(header, row)))
        if why:
            entries.append((f"line {number}", f"<{why}>"))
            continue
        for name, value in zip(header, row):
            is_number = re.fullmatch(r"[-+]?(\d.*|inf|nan)", value)
            entries.append((f"line {number}, {name}",
                            rules.value(name, Number(value) if is_number else value)))
    return entries


def read_text(data, rules):
    """Lines; in tables of Markdown each cell by the name of its column."""
    entries, header = [], None
    for number, line in enumerate(data.decode(errors="replace").split("\n"), 1):
        cells = [cell.strip() for cell in line.split("|")[1:-1]] if line[:1] == "|" else None
        if cells and header and len(cells) == len(header):
            row = dict(zip(header, cells))
            why = rules.why_row_differs(row)
            line = f"<{why}>" if why else "| " + " | ".join(
                str(rules.value(name, value)) for name, value in row.items()) + " |"
        header = (header or cells) if cells else None
        entries.append((f"line {number}", rules.text(line)))
    return entries


def read_bytes(data, rules):
    del rules
    return [("size", str(len(data)))] + [
        (f"bytes from {at}", data[at:at + 32].hex()) for at in range(0, len(data), 32)]


def _exr_attributes(data):
    at, found = 8, []
    while data[at]:
        end = data.index(b"\0", at)
        name, at = data[at:end].decode(), end + 1
        end = data.index(b"\0", at)
        kind, at = data[at:end].decode(), end + 1
        size, = struct.unpack_from("<i", data, at)
        found.append((name, kind, data[at + 4:at + 4 + size]))
        at += 4 + size
    return found, at + 1


def read_exr(data, rules):
    """Attributes in their order, then the chunks of pixels, independent of their offsets."""
    attributes, table = _exr_attributes(data)
    entries, window = [], None
    for name, kind, value in attributes:
        shown = value.decode() if kind == "string" else value.hex()
        entries.append((f"{name} ({kind})", str(rules.value(name, shown))))
        if name == "dataWindow":
            window = struct.unpack("<4i", value)
        if name == "compression":
            rows_per_chunk = {0: 1, 1: 1, 2: 1, 3: 16}[value[0]]
    chunks = -(-(window[3] - window[1] + 1) // rows_per_chunk)
    for offset in struct.unpack_from(f"<{chunks}Q", data, table):
        row, size = struct.unpack_from("<ii", data, offset)
        pixels = data[offset + 8:offset + 8 + size]
        entries += [(f"row {row}, packed bytes from {at}", pixels[at:at + 32].hex())
                    for at in range(0, size, 32)]
    return entries


def read_database(path, rules):
    """Every row of every table, in the order of the primary keys."""
    entries = []
    database = sqlite3.connect(f"file:{path}?mode=ro&immutable=1", uri=True)
    tables = database.execute("SELECT name, sql FROM sqlite_master ORDER BY name").fetchall()
    for table, sql in tables:
        entries.append((table, str(sql)))
        if not (sql or "").startswith("CREATE TABLE"):
            continue
        cursor = database.execute(f"SELECT * FROM {table}")
        names = [column[0] for column in cursor.description]
        for number, row in enumerate(cursor):
            for name, value in zip(names, row):
                if isinstance(value, (int, float)):
                    value = Number(repr(value))
                entries.append((f"{table}[{number}].{name}",
                                str(rules.value(f"{table}.{name}", value))))
    database.close()
    return entries


READERS = (
    ("*.json", read_json), ("*data.js", read_script_data), ("*.csv", read_csv),
    ("*.exr", read_exr), ("*.png", read_bytes), ("*.vdb", read_bytes), ("*.df3", read_bytes),
    ("*.stdout", read_text), ("*.stderr", read_text), ("*.txt", read_text), ("*.md", read_text),
    ("*.log", read_text), ("*.xml", read_text), ("*.svg", read_text), ("*.html", read_text),
    ("*.js", read_text), ("*.css", read_text), ("*.yaml", read_text), ("*.pov", read_text),
    ("*.py", read_text), ("*.inc", read_text), ("*.code", read_text), ("*", read_bytes))


def readers_of_output(path, data):
    """Readers to try for the stdout of a command: JSON, CSV, text."""
    command = path.with_suffix(".command.txt")
    says_csv = command.is_file() and "csv -" in command.read_text()
    return ((read_json,) if data[:1] in (b"{", b"[") else ()) + (
        (read_csv,) if says_csv else ()) + (read_text,)


def entries_of(path, rules):
    """The compared parts of a file: (place in it, text) in order."""
    if rules.presence_only:
        return []
    if path.suffix == ".sqlite":
        return read_database(path, rules)
    data = path.read_bytes()
    readers = readers_of_output(path, data) if path.suffix == ".stdout" else [
        reader for pattern, reader in READERS if fnmatch.fnmatch(path.name, pattern)]
    for reader in readers:
        try:
            return reader(data, rules)
        except ValueError:  # the content is not what the name implies: compared by the next reader
            pass
    return read_bytes(data, rules)


def different_entries(before, after):
    """(place, before, after) of all differences; None: absent."""
    if before == after:
        return []
    known, new = dict(before), dict(after)
    found = [(place, value, new.get(place)) for place, value in before if new.get(place) != value]
    found += [(place, None, value) for place, value in after if place not in known]
    if not found:
        found = [("order", str([place for place, _ in before])[:200],
                  str([place for place, _ in after])[:200])]
    return found


def files_of(folder):
    found = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*"))
             if path.is_file() or path.is_symlink()}
    return {name: path for name, path in found.items()
            if not any(fnmatch.fnmatch(name, pattern) for pattern, _ in LEFT_OUT_RULES)}


def compare_case(case, before, after):
    """(file, place, before, after) of all differences between two folders of a case."""
    sides = [(files_of(folder), folder) for folder in (before, after)]
    found = []
    for name in sorted(sides[0][0].keys() | sides[1][0].keys()):
        if not all(name in files for files, _ in sides):
            there = name in sides[0][0]
            found.append((name, "file", "is there" if there else None,
                          None if there else "is there"))
            continue
        first, second = (entries_of(files[name], Rules(case, name, folder.parent))
                         for files, folder in sides)
        found += [(name, *difference) for difference in different_entries(first, second)]
    return found


# ---- runs ----------------------------------------------------------------------------------------


class CannotCompare(Exception):
    """With a sentence for the user: exit code 2."""


BUILD_ID = bytes(range(1, 21))


def with_same_build_id(data):
    """The bytes of a program with another build id. The build id is a part of the keys of stored
    frames: with the same id for both builds the keys are equal, and each build finds the frames of
    the other. The note is a header, "GNU" and 20 bytes."""
    head = struct.pack("<III", 4, 20, 3) + b"GNU\0"
    at = data.find(head)
    if at < 0 or data.find(head, at + 1) >= 0:
        raise CannotCompare("the program has no build id, or several: "
                         "link it with -Wl,--build-id=sha1")
    at += len(head)
    return data[:at] + BUILD_ID + data[at + 20:]


def install(program, folder):
    """A copy of the program, under the same name in each record."""
    place = folder / ".program" / "neph"
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_bytes(with_same_build_id(program.read_bytes()))
    place.chmod(0o755)
    return place


def all_commands(quick, only):
    """{case: [arguments]} in the order of the table."""
    rows = [[field.strip() for field in re.sub(r" +", " ", line).split("|", 2)]
            for line in COMMANDS.strip().split("\n")]
    names = VERBS + [f"study {kind}" for kind in STUDIES]
    rows += [("help", "quick", words) for words in ["--help", "--version"] +
             [f"{name} --help" for name in names] + [f"{name} --usage" for name in names]]
    rows += [("wrong words", "quick", words) for words in
             [f"{name} --no-such-option" for name in names] + list(WRONG_WORDS)]
    chosen, cases = re.compile(only or ""), {}
    for case, which, words in rows:
        if quick and which != "quick":
            continue
        if words == "first":
            words = cases[STARTS_WITH[case]][0]
        cases.setdefault(case, []).append(words)
    return {case: commands for case, commands in cases.items()
            if any(chosen.search(f"{case}: {words}") for words in commands)}


def stored_frames(folder):
    """The records of all stored frames: a re-rendered frame has another one."""
    return {path.relative_to(folder).as_posix(): path.read_bytes()
            for path in folder.glob("**/store/frames/*/job.json")}


def make_older(folder):
    """A nightly run lists frames that were used some seconds before it began as its own: this sets
    them an hour back between two commands, so that the list does not depend on their speed."""
    for path in folder.glob("**/store/frames/*/job.json"):
        status = path.stat()
        os.utime(path, (status.st_atime, status.st_mtime - 3600))


def run_case(program, case, commands, record, start):
    """Writes RECORD/CASE/files and the output of each command."""
    place = record / case.replace(" ", "_")
    if place.exists() and not (place / "00.command.txt").is_file():
        raise CannotCompare(f"'{place}' is no record of this script: name another folder")
    shutil.rmtree(place, ignore_errors=True)
    files = place / "files"
    place.mkdir(parents=True)
    (place / "00.command.txt").touch()
    if start:
        shutil.copytree(start / "files", files, symlinks=True)
    files.mkdir(exist_ok=True)
    for name, text in INPUTS.items():
        if any(name in words for words in commands):
            (files / name).write_text(text)
    before, environment = stored_frames(files), {
        name: value for name, value in os.environ.items()
        if not name.startswith("NEPH_") and name not in ("COLUMNS", "ARGP_HELP_FMT")}
    environment.update(XDG_CACHE_HOME=str(record / ".cache"),
                       MESA_SHADER_CACHE_DIR=str(record / ".cache"), LC_ALL="C.UTF-8")
    seconds = 0.0
    for number, words in enumerate(commands):
        make_older(files)
        begun = time.monotonic()
        done = subprocess.run([program, *shlex.split(words)], cwd=files, env=environment,
                              stdin=subprocess.DEVNULL, capture_output=True, check=False)
        seconds += time.monotonic() - begun
        name = f"{number:02}"
        (place / f"{name}.command.txt").write_text(f"neph {words}\n")
        (place / f"{name}.stdout").write_bytes(done.stdout)
        (place / f"{name}.stderr").write_bytes(done.stderr)
        (place / f"{name}.code").write_text(f"{done.returncode}\n")
    if start:
        after = stored_frames(files)
        anew = sorted(name for name in after if before.get(name) != after[name])
        (place / "rendered_anew.txt").write_text("".join(f"{name}\n" for name in anew))
    return seconds


def run_list(program, cases, record, before):
    """Runs all cases into the folder `record`. Cases that start with a folder of another case take
    it from the record `before`."""
    copy = install(program, record)
    for number, (case, commands) in enumerate(cases.items(), 1):
        start = STARTS_WITH.get(case)
        if start:
            start = before / start.replace(" ", "_")
            if not start.is_dir():
                raise CannotCompare(f"'{case}' needs the case "
                                 f"'{STARTS_WITH[case]}' in {before}: record it first")
        seconds = run_case(copy, case, commands, record, start)
        print(f"[{number}/{len(cases)}] {case}: {len(commands)} commands, {seconds:.1f} s",
              file=sys.stderr, flush=True)


def compare_records(cases, before, after, limit):
    """Prints all differences; returns their number."""
    total = 0
    for case, commands in cases.items():
        name = case.replace(" ", "_")
        if not (before / name).is_dir():
            raise CannotCompare(f"the record {before} has no case '{case}'")
        found = compare_case(case, before / name, after / name)
        anew = after / name / "rendered_anew.txt"
        if anew.is_file():
            found += [("rendered_anew.txt", "frame", "stored", frame)
                      for frame in anew.read_text().split()]
        total += len(found)
        for file, place, first, second in found[:limit]:
            number = re.match(r"\d\d(?=\.)", file)
            said = f"neph {commands[int(number[0])]}" if number else "its files"
            print(f"{case}: {said}\n  {file}, {place}:\n    before: {first}\n    after:  {second}")
        if len(found) > limit:
            print(f"{case}: {len(found) - limit} more differences (--limit)")
    return total


HELP = """
Programs are paths of two builds of neph. Each command runs in a folder of its own; all output, exit
codes and files are then compared to the last digit. Only what a table of rules in this script names
may differ: times, dates, the machine, absolute paths of output folders. Cases named `again` start
with the folder that the BEFORE program left: no frame may be rendered anew there.

Examples:
  same_measurements.py --list
  same_measurements.py --quick old/neph new/neph
  same_measurements.py --record before old/neph               # once
  same_measurements.py --before-from before new/neph          # after each change
  same_measurements.py --before-from before --only 'night' new/neph --keep after

Exit codes: 0 no difference; 1 differences; 2 wrong usage.
"""


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(description=__doc__, epilog=HELP,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="*", type=pathlib.Path, metavar="PROGRAM",
                        help="BEFORE and AFTER; only one with --record or --before-from")
    parser.add_argument("--list", action="store_true", help="print the commands and run none")
    parser.add_argument("--rules", action="store_true",
                        help="print what may differ, with the reasons")
    parser.add_argument("--quick", action="store_true", help="the quick list, some three minutes")
    parser.add_argument("--only", metavar="PATTERN",
                        help="cases of which a line 'CASE: ARGUMENTS' matches this expression")
    parser.add_argument("--record", type=pathlib.Path, metavar="DIR",
                        help="run BEFORE and keep what it leaves in DIR")
    parser.add_argument("--before-from", type=pathlib.Path, metavar="DIR",
                        help="what --record has kept, in place of running BEFORE")
    parser.add_argument("--keep", type=pathlib.Path, metavar="DIR",
                        help="keep what AFTER leaves in DIR (BEFORE's in DIR/before)")
    parser.add_argument("--compare", type=pathlib.Path, metavar="DIR",
                        help="run nothing; compare DIR, kept by --keep, with --before-from")
    parser.add_argument("--limit", type=int, default=20, metavar="N",
                        help="differences that are printed of each case (default: 20)")
    options = parser.parse_args(arguments)
    wanted = 0 if options.list or options.rules or options.compare else \
        1 if options.record or options.before_from else 2
    if len(options.programs) != wanted:
        parser.error(f"{wanted} programs are needed here, not {len(options.programs)}")
    if options.record and options.before_from:
        parser.error("--record and --before-from exclude each other")
    if options.compare and not options.before_from:
        parser.error("--compare needs --before-from")
    for program in options.programs:
        if not program.is_file():
            parser.error(f"there is no program '{program}'")
    return options


def print_rules():
    for case, file, pattern, why in KEY_RULES:
        print(f"key   {case} {file} {pattern}: {why}")
    for case, file, pattern, _, why in TEXT_RULES:
        print(f"text  {case} {file} {pattern}: {why}")
    for case, file, why in PRESENCE_RULES:
        print(f"file  {case} {file}: {why}")
    for case, key, value, why in ROW_RULES:
        print(f"row   {case} {key} {value}: {why}")
    for file, why in LEFT_OUT_RULES:
        print(f"none  * {file}: {why}")
    for case, why in FORM_ONLY.items():
        print(f"form  {case}: {why}")


def compare_programs(options, cases, scratch):
    """Returns the exit code."""
    after = (options.compare or options.keep or scratch / "after").resolve()
    before = (options.before_from or (options.keep or scratch) / "before").resolve()
    if not options.before_from:
        run_list(options.programs[0], cases, before, before)
    if not options.compare:
        run_list(options.programs[-1], cases, after, before)
    differences = compare_records(cases, before, after, options.limit)
    commands = sum(map(len, cases.values()))
    print(f"{differences} differences in {len(cases)} cases, {commands} commands")
    return 1 if differences else 0


def run(options):
    """Returns the exit code."""
    cases = all_commands(options.quick, options.only)
    if not cases:
        raise CannotCompare(f"no command matches '{options.only}'; see --list")
    if options.list:
        for case, commands in cases.items():
            print("\n".join(f"{case}: neph {words}" for words in commands))
        return 0
    if options.rules:
        print_rules()
        return 0
    if options.record:
        run_list(options.programs[0], cases, options.record.resolve(), options.record.resolve())
        return 0
    with tempfile.TemporaryDirectory() as scratch:
        return compare_programs(options, cases, pathlib.Path(scratch))


def main(arguments):
    try:
        return run(parse_arguments(arguments))
    except CannotCompare as problem:
        print(f"same_measurements: {problem}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
