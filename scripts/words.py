#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Habits of language per 1,000 words, and names that are no names, beside their limits.

    scripts/words.py             one line; exit code 1 where a limit is passed
    scripts/words.py --all       every rate, and each place of a habit that is over its limit
    scripts/words.py --places HABIT [FOLDER]    every place of one habit: FILE:LINE: text

Counted are comments of C, C++ and shaders outside of tests; the Markdown of README.md,
CONTRIBUTING.md, docs/, scenes/ and results/; messages (string literals of C with at least four
words); the report pages (comments and such literals of scripts/report/*.js).
Limits are two to three times the highest rate in libplacebo, pbrt-v4, Mitsuba 3, dav1d and
VMAF (2026-11), and at least 0.5. A function is named by a verb and its object: the names in
scripts/words_allowed.txt end in `_of` or are a bare verb and are yet to be renamed. That list only
shrinks: a name that is no longer in the code fails, too.
"""
import argparse
import os
import pathlib
import re
import sys

ROOT = pathlib.Path(os.environ.get("NEPH_SOURCE_DIR",
                                   pathlib.Path(__file__).resolve().parent.parent))
ALLOWED = ROOT / "scripts/words_allowed.txt"
# Pattern, limit per 1,000 words.
HABITS = {
    "what/who as a noun": (r"\b([Ww]hat|[Ww]hoever|[Ww]hose|[Ww]ho)\b", 1.5),
    "nobody/somebody": (r"\b([Nn]obody|[Ss]omebody)\b", 0.5),
    "alone for only": (r"\balone\b", 0.5),
    "that of/those of": (r"\b(that|those) of\b", 0.5),
    "rest(s)/at rest": (r"\b(at rest|rests?|resting)\b", 0.6),
    "ask(s/ed)": (r"\b(asks?|asked)\b", 0.5),
    "held/hold(s)": (r"\b(held|holds?)\b", 1.2),
    "picture(s)": (r"\bpictures?\b", 2.0),
    "anew": (r"\banew\b", 0.5),
}
FOLDERS = ("base", "docs", "harness", "metrics", "renderer", "results", "scenes", "scripts",
           "tests", "truth")
CODE = {".c", ".h", ".cpp", ".comp", ".glsl"}
SHADERS = {".comp", ".glsl"}
SCRIPT = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:[^"\\\n]|\\.)*"|`(?:[^`\\]|\\.)*`', re.S)
TOKEN = re.compile(r'(?P<comment>/\*.*?\*/|//[^\n]*)|(?P<string>(?:"(?:[^"\\\n]|\\.)*"\s*)+)', re.S)
BANNED_NAME = re.compile(r"\b(\w+_of|rests|own|asks|knows|tells|holds|wakes|looks)\(")


def files():
    """(name, path) of all files that are counted."""
    found = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.*"))]
    for path in sorted(ROOT.glob("*.md")) + found:
        name = path.relative_to(ROOT).as_posix()
        if path.is_file() and not re.search(r"corpus|node_modules|__pycache__", name):
            yield name, path


def is_product(name, suffix):
    return suffix in CODE and not name.startswith("tests/") and "/check_" not in name


def prose(text):
    """Markdown without code, comments and tables, its lines kept."""
    text = re.sub(r"```.*?```|<!--.*?-->", lambda found: "\n" * found[0].count("\n"), text,
                  flags=re.S)
    return re.sub(r"^\|.*$", "", text, flags=re.M)


def texts():
    """(kind, file, line, text) of all that is counted."""
    for name, path in files():
        text = path.read_text(encoding="utf8", errors="ignore")
        if path.suffix == ".md" and not name.startswith("tests/"):
            for number, line in enumerate(prose(text).split("\n"), 1):
                yield "docs", name, number, line
        if path.suffix == ".js" and name.startswith("scripts/report/"):
            for found in SCRIPT.finditer(text):
                if len(re.findall(r"[A-Za-z']{2,}", found[0])) >= 4:
                    yield "pages", name, text.count("\n", 0, found.start()) + 1, found[0]
        if not is_product(name, path.suffix):
            continue
        for found in TOKEN.finditer(text):
            line = text.count("\n", 0, found.start()) + 1
            if found["comment"]:
                yield "comments", name, line, found[0]
            elif path.suffix not in SHADERS:
                said = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', found[0]))
                if len(re.findall(r"[A-Za-z']{2,}", said)) >= 4:
                    yield "messages", name, line, said


def count():
    """Words of each kind, and the places of each habit in it."""
    words, places = {}, {}
    for kind, name, line, text in texts():
        words[kind] = words.get(kind, 0) + len(re.findall(r"[A-Za-z']+", text))
        for habit, (pattern, _) in HABITS.items():
            for _ in re.findall(pattern, text):
                places.setdefault((kind, habit), []).append(f"{name}:{line}: {text.strip()}")
    return words, places


def banned_names():
    found = set()
    for name, path in files():
        if path.suffix in CODE:
            code = TOKEN.sub(" ", path.read_text(encoding="utf8", errors="ignore"))
            found |= set(BANNED_NAME.findall(code))
    return found


def main():
    summary, _, details = __doc__.partition("\n\n")
    parser = argparse.ArgumentParser(description=summary, epilog=details,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="every rate and place")
    parser.add_argument("--places", metavar="HABIT", help="places of one habit")
    parser.add_argument("folder", nargs="?", default="", help="only files whose path starts so")
    options = parser.parse_args()
    words, places = count()
    if options.places:
        for (kind, habit), found in sorted(places.items()):
            if options.places in habit:
                print("".join(f"{kind}: {place}\n" for place in found
                              if place.startswith(options.folder)), end="")
        return 0
    rates = {(kind, habit): 1000 * len(places.get((kind, habit), [])) / words[kind]
             for kind in words for habit in HABITS}
    over = [f"{kind}: {habit} {rate:.1f} (limit {HABITS[habit][1]})"
            for (kind, habit), rate in rates.items() if rate > HABITS[habit][1]]
    allowed = set(ALLOWED.read_text().split())
    names = banned_names()
    over += [f"{name}() is to be named by a verb and its object"
             for name in sorted(names - allowed)]
    over += [f"{name} is no longer in the code: remove it from {ALLOWED.name}"
             for name in sorted(allowed - names)]
    if options.all:
        for (kind, habit), rate in rates.items():
            print(f"{kind:10}{habit:22}{rate:6.2f} of {HABITS[habit][1]}")
            if rate > HABITS[habit][1]:
                print("".join(f"    {place}\n" for place in places[kind, habit]), end="")
    largest = max(rates, key=lambda key: rates[key] / HABITS[key[1]][1])
    print(f"Words: {', '.join(f'{kind} {number}' for kind, number in words.items())}; nearest to "
          f"its limit per 1,000: {largest[1]} in {largest[0]}, {rates[largest]:.2f} of "
          f"{HABITS[largest[1]][1]}; {len(allowed)} names to be renamed")
    for line in over:
        print(f"words: {line}", file=sys.stderr)
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main())
