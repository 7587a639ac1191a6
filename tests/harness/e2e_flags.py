#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The vocabulary of flags over all verbs, as in docs/flags.md; deprecated names warn."""
import collections
import pathlib
import re
import sys
import unittest

import neph_case
from neph_case import ROOT

OPTION = re.compile(r"^  (?:-(?P<letter>\S), |    )--(?P<name>[\w-]+)(?:=(?P<argument>\S+))?"
                    r"(?: +(?P<text>.*))?$")
TEXT_COLUMN = 29
# Verbs that share a table of options, or run one after the other in one folder.
FAMILIES = {"export": "render", "flicker": "compare"}
# Names that look like the plural of another and have a meaning of their own: the number of frames,
# seeds or steps of a ray; a list of masks; a file of limits.
PLURALS = {"frames", "seeds", "steps", "masks", "limits"}

Flag = collections.namedtuple("Flag", "verb letter argument text")


def ask(*words):
    done = neph_case.run(*words, "--help")
    assert done.returncode == 0, (words, done.stderr)
    return done.stdout


def verbs():
    """The words of each verb; each kind of study counts as one."""
    names = re.findall(r"^  (\w+) +", ask().split("\n\n`neph")[0], re.MULTILINE)
    kinds = re.findall(r"^  (\w+) +", ask("study").split("\n\nExamples")[0], re.MULTILINE)
    return [(name,) for name in names if name != "study"] + [("study", kind) for kind in kinds]


def options(words):
    """{name: Flag} of the help of a verb."""
    found, name = {}, None
    for line in ask(*words).splitlines():
        option = OPTION.match(line)
        if option:
            name = option["name"]
            found[name] = Flag(" ".join(words), option["letter"], option["argument"],
                               option["text"] or "")
        elif name and line.startswith(TEXT_COLUMN * " "):
            found[name] = found[name]._replace(text=f"{found[name].text} {line.strip()}".strip())
        else:
            name = None
    return found


def rows(heading):
    """The cells of the table below a heading of the page."""
    text = (ROOT / "docs/flags.md").read_text().split(heading)[1]
    table = re.search(r"\n\|.*?\n\n", text, re.DOTALL)[0].strip().splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in table]


def documented():
    """{name: (letter, argument, defaults)} on the page."""
    found = {}
    for flag, defaults, _ in rows("# One vocabulary"):
        option = re.fullmatch(r"`(?:-(\w), )?--([\w-]+)(?:=(\S+))?`", flag)
        found[option[2]] = option[1], option[3], defaults.split("; ")
    return found


def form(argument):
    """One form for the argument of settings: an engine that may be omitted, an extractor, a
    chain."""
    return re.sub(r"^(\[ENGINE:\]|ENGINE:|EXTRACTOR:)?KEY=VALUE$", "KEY=VALUE", argument or "")


class Flags(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.verbs = {" ".join(words): options(words) for words in verbs()}
        cls.flags = collections.defaultdict(list)
        for found in cls.verbs.values():
            for name, flag in found.items():
                if name not in ("help", "usage"):
                    cls.flags[name].append(flag)
        cls.flags = dict(cls.flags)

    def shared(self):
        """Names that belong to more than one family of verbs."""
        return {name: flags for name, flags in self.flags.items()
                if len({FAMILIES.get(flag.verb, flag.verb) for flag in flags}) > 1}

    def test_all_verbs_were_read(self):
        self.assertGreater(len(self.verbs), 25)
        self.assertGreater(len(self.shared()), 30)

    def test_a_name_has_one_letter_and_one_form_of_its_argument(self):
        for name, flags in self.flags.items():
            forms = {(flag.letter, form(flag.argument)) for flag in flags}
            self.assertEqual(len(forms), 1, (name, sorted(flags)))

    def test_a_letter_stands_for_one_name(self):
        names = collections.defaultdict(set)
        for name, flags in self.flags.items():
            names[flags[0].letter].add(name)
        del names[None]
        self.assertEqual({letter: found for letter, found in names.items() if len(found) > 1}, {})

    def test_the_page_has_exactly_shared_flags(self):
        page = documented()
        self.assertEqual(sorted(set(self.shared()) - set(page)), [])
        gone = sorted(name for name in page if name not in self.flags)
        self.assertEqual(gone, [])
        for name, (letter, argument, _) in page.items():
            flag = self.flags[name][0]
            self.assertEqual((flag.letter, form(flag.argument)), (letter, form(argument)), name)

    def test_defaults_are_those_of_the_page(self):
        for name, (_, argument, allowed) in documented().items():
            for flag in self.flags[name]:
                said = re.search(r"\(default: ([^();,]*(?:, else \d+)?)", flag.text)
                if not said or allowed == ["own"] or not argument:
                    continue
                verb = flag.verb.split()[0]
                wanted = [word.replace("VERB", "nightly" if verb in ("baseline", "serve")
                                       else verb)
                          for word in allowed]
                self.assertTrue(any(said[1].startswith(word) for word in wanted),
                                (flag.verb, name, said[1], wanted))

    def test_every_verb_has_the_common_flags(self):
        for verb, found in self.verbs.items():
            for name in "json", "quiet":
                self.assertIn(name, found, verb)

    def test_no_two_names_of_one_thing(self):
        plurals = {name for name in self.flags if name.endswith("s") and name[:-1] in self.flags}
        self.assertEqual(plurals - PLURALS, set())
        texts = collections.defaultdict(set)
        for name, flags in self.flags.items():
            for flag in flags:
                texts[flag.text].add(name)
        self.assertEqual([names for text, names in texts.items() if text and len(names) > 1], [])

    def test_old_names_warn_in_one_line_and_work(self):
        table = old_options()
        self.assertEqual((ROOT / "docs/flags.md").read_text(), page_of_flags())
        page = [tuple(cell.strip("`").removeprefix("--") for cell in row)
                for row in rows("## Old names")]
        self.assertEqual(page, table)
        for verb, old, new in table:
            self.assertIn(new, self.verbs[verb], verb)
            self.assertNotIn(old, self.verbs[verb], verb)
            value = "=5" if self.verbs[verb][new].argument else ""
            done = neph_case.run(*verb.split(), f"--{old}{value}", "--help")
            self.assertEqual(done.returncode, 0, (verb, old, done.stderr))
            self.assertEqual(done.stderr, f"neph {verb}: --{old} is now --{new}; the old spelling "
                             "goes with the next release\n")
            self.assertEqual(neph_case.run(*verb.split(), f"--{new}{value}", "--help").stderr, "")


def commands():
    """(page, words) of every command of neph that a page shows in a block of code or in a line."""
    pages = [ROOT / "README.md", ROOT / "scenes/README.md", *sorted((ROOT / "docs").glob("*.md"))]
    for path in pages:
        text = path.read_text().replace("\\\n", " ")
        blocks = re.findall(r"^```\w*\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
        lines = [line for block in blocks for line in block.splitlines()]
        lines += [line.replace("\n", " ") for line in re.findall(r"`(neph [^`]+)`", text)]
        for line in lines:
            found = re.search(r"(?:^|[|&;(] ?|\w=\S+ )neph ((?:study )?[a-z]+\b[^|&;>#]*)", line)
            if found:
                yield path.name, found[1].split()


WRITTEN = re.compile(
    r"(<!-- written by tests/harness/e2e_flags.py --write -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def with_table(page, rows):
    """A page with the rows in its written table, whose head stays."""
    def renew(match):
        head = "".join(match[2].splitlines(keepends=True)[:2])
        return f"{match[1]}{head}{rows}\n{match[3]}"
    return WRITTEN.sub(renew, (ROOT / page).read_text())


def page_of_verbs():
    """docs/verbs.md with the table of verbs as `neph --help` has it."""
    found = re.findall(r"^  (\w+) +(.*)$", ask().split("\n\n`neph")[0], re.MULTILINE)
    return with_table("docs/verbs.md",
                      "".join(f"| `{name}` | {text} |\n" for name, text in found))


def old_options():
    """(verb, old, new) of each row in the code."""
    return re.findall(r'^    \{"([\w ]+)", "([\w-]+)", "([\w-]+)"\},$',
                      (ROOT / "harness/old_options.c").read_text(), re.MULTILINE)


def page_of_flags():
    """docs/flags.md with the table of old names as the code has it."""
    return with_table("docs/flags.md", "".join(f"| `{verb}` | `--{old}` | `--{new}` |\n"
                                               for verb, old, new in old_options()))


class Pages(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.verbs = {" ".join(words): options(words) for words in verbs()}

    def test_commands_of_the_pages_exist(self):
        wrong, count = [], 0
        for page, words in commands():
            verb = " ".join(words[:2]) if words[0] == "study" else words[0]
            flags = self.verbs.get(verb)
            if flags is None:
                if words[0] != "study" or len(words) > 1 and words[1].islower():
                    wrong.append(f"{page}: neph {' '.join(words)}: no such verb")
                continue
            letters = {flag.letter for flag in flags.values()}
            for word in words:
                name = re.match(r"--([\w-]+)|-(\w)", word)
                count += name is not None
                if name and not (name[1] in {*flags, "help"} or name[2] in letters):
                    wrong.append(f"{page}: neph {' '.join(words)}: no {word}")
        self.assertEqual(wrong, [])
        self.assertGreater(count, 50)

    def test_the_page_has_every_verb(self):
        page = (ROOT / "docs/verbs.md").read_text()
        self.assertRegex(page, WRITTEN)
        self.assertEqual(page, page_of_verbs())

    def test_the_manual_has_every_flag(self):
        folder = pathlib.Path(neph_case.NEPH).parent / "man"
        for verb, flags in self.verbs.items():
            text = (folder / f"neph-{verb.replace(' ', '-')}.1").read_text().replace("\\-", "-")
            for name, flag in flags.items():
                argument = f"={flag.argument}" if flag.argument else ""
                self.assertRegex(text, rf"\n\.B (-., )?--{re.escape(name + argument)}\n", verb)


class Commands(neph_case.NephCase):
    in_folder = True

    def test_settings_of_extractors_with_a_dot(self):
        self.neph("render", "absorbing_slab", "-e", "exact", "--size", "8x8", "-o", ".")
        frame = self.folder / "absorbing_slab_exact_0000.exr"
        words = ("compare", frame, frame, "-m", "flip", "-q")
        self.neph(*words, "-s", "flip.nonsense=1", code=64,
                  said=("-s flip.nonsense=1 is now -s flip:nonsense=1", "nonsense"))
        done = self.neph(*words, "-s", "flip:nonsense=1", code=64, said="nonsense")
        self.assertNotIn("is now", done.stderr)

    def test_a_volume_file_by_its_letter(self):
        small = ("--resolution", "2", "-q")
        self.neph("bake", "gaussian_blob", "-o", "old.vdb", *small, said="neph bake SCENE FILE")
        self.assertEqual(self.neph("bake", "gaussian_blob", "new.vdb", *small).stderr, "")
        self.neph("bake", "gaussian_blob", *small)
        files = [self.folder / name for name in ("old.vdb", "new.vdb",
                                                 "out/bake/gaussian_blob.vdb")]
        self.assertEqual(len({path.stat().st_size for path in files}), 1)

    def test_lists_by_comma_and_repeated_are_the_same(self):
        words = ("validate", "absorbing_slab", "--no-charts", "--size", "8x8", "-q")
        by_comma = self.json(*words, "-e", "exact,oracle")
        repeated = self.json(*words, "-e", "exact", "-e", "oracle")
        names = [[frame["engine"] for frame in found["scenes"][0]["frames"]]
                 for found in (by_comma, repeated)]
        self.assertEqual(names, [["exact", "oracle"]] * 2)
        self.neph(*words, "-e", "exact,exact", code=64, said="'exact' is twice")
        self.neph("render", "absorbing_slab", "-e", "exact,march", code=64, said="not several")
        self.neph("render", "absorbing_slab", "-e", "exact", "-e", "march", code=64,
                  said="not several")
        self.assertTrue((self.folder / "out/validate/store").is_dir())

    def test_every_verb_says_where_its_results_are(self):
        little = ("--size", "16x9")
        frame = "out/render/height_fog_level_march_0000.exr"
        for words, code, place in (
                (("render", "height_fog_level", *little), 0, frame),
                (("export", "absorbing_slab", *little), 0, "out/export"),
                (("bake", "gaussian_blob", "--resolution", "2"), 0, "out/bake/gaussian_blob.vdb"),
                (("view", "-r", frame, frame), 0, "out/view/index.html"),
                (("post", frame, "-r", frame, "-p", "unreal"), 0, "out/post"),
                (("pick", "height_fog_level", "--error", "0.01", *little), 0, "out/pick/pick.json"),
                (("study", "steps", "march", "height_fog_up", "--size", "4x4"), 0, "out/study"),
                (("sweep", "height_fog_level", "--untimed", "--only", "march", *little), 0,
                 "out/sweep"),
                (("conform", "--only", "height_fog_level", "-e", "march", *little), 0,
                 "out/conform"),
                (("validate", "absorbing_slab", "-e", "exact,oracle", "--no-charts", *little), None,
                 "out/validate/report/index.html")):
            done = self.neph(*words, code=code)
            self.assertIn(place, done.stdout + done.stderr)
            self.assertTrue((self.folder / place).exists(), place)
        shown = [(self.folder / "out/post" / name / pathlib.Path(frame).name).read_bytes()
                 for name in ("", "reference")]
        self.assertEqual(*shown)

    def test_a_store_of_before_is_named_once(self):
        words = ("validate", "absorbing_slab", "-e", "exact,oracle", "--no-charts", "--size", "8x8",
                 "-q")
        self.neph(*words, "-o", "out")
        self.neph(*words, said="-o out uses again")
        self.assertNotIn("uses again", self.neph(*words).stderr)
        again = self.json(*words, "-o", "out")
        self.assertEqual([frame["reused"] for frame in again["scenes"][0]["frames"]],
                         [True, True])

    def test_a_setting_with_and_without_its_engine(self):
        words = ("render", "height_fog_level", "--size", "8x8", "-q", "-s")
        for setting in "march:steps=5", "steps=5":
            self.neph(*words, setting, "-o", setting)
        frames = [self.folder / name / "height_fog_level_march_0000.exr"
                  for name in ("march:steps=5", "steps=5")]
        numbers = self.json("compare", *frames, "-m", "max_abs")["measurements"]
        self.assertEqual({row["value"] for row in numbers if row["metric"] == "max_abs"} - {None},
                         {0.0})
        self.neph(*words, "tracer:steps=5", code=64, said="tracer:steps")


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        (ROOT / "docs/verbs.md").write_text(page_of_verbs())
        (ROOT / "docs/flags.md").write_text(page_of_flags())
    else:
        unittest.main()
