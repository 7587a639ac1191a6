#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The settings of the marches and of the real-time renderer, each defined once in a settings.toml:

    settings.py ROOT FOLDER   what C and GLSL have of them, as files in FOLDER
    settings.py ROOT --docs   docs/settings.md, on stdout

A table of such a file is a setting. Its keys:
    number     its place among the settings of `realtime`: in lists, and in the text that is the key
               of stored work. A new setting takes the next number; a number is never used again
    kind       "switch" (off, on), "whole", "real"; without it a choice of `choices`; "pipeline": a
               choice that no user has, which the pipeline makes in a view, with the same bits
    choices    the words, in the order of their numbers from 0 on
    constants  GLSL and C have RT_<constants>_<WORD> for the words; settings may share them
    default    a word or a number; march_settings.toml: {traced = 8, realtime = 2} where it differs
    range      [least, most]: numbers, or constants of renderer/march_params.h by their names
    id         GLSL and C have RT_<id>; without it the name in capitals
    field      of the folder's struct in struct neph_rt_settings; without it the name;
               march_settings.toml: of struct neph_march_params. A list: a number is in each of
               them; of a choice each is a bool, the first true from the second word on
    type       march_settings.toml: the C type of that field
    bit        march_settings.toml: of a shortcut, in the specialization constant SHORTCUTS, set
               where it is on, or above its least value: NEPH_SHORTCUT_<NAME>. A number with a bit
               is a member of the uniform Frame, too
    engines    march_settings.toml: tables that have it, of "march", "traced", "diffused" and
               "realtime"; without it those of all marches, and realtime if it has a number
    help       one line, with the unit
"""
import pathlib
import re
import sys
import textwrap
import tomllib

KEYS = {"number", "kind", "choices", "constants", "default", "range", "id", "field", "type", "bit",
        "engines", "help"}
LONGEST_OTHER = 64  # options of a table that is no file settings.toml, at most
MARCHES = ("march", "traced", "diffused")
# Fields that a march has in another form: the C type of the user's, and what makes one of it.
CONVERTED = {"sky": ("struct neph_march_sky_choices", "neph_march_sky_choose"),
             "fog": ("int", "neph_march_fog_choose")}
C_KIND = {"switch": "CHOICE", "choice": "CHOICE", "pipeline": None, "whole": "WHOLE",
          "real": "REAL"}
C_TYPE = {"switch": "bool", "choice": "int", "whole": "int", "real": "double"}


class Setting:
    def __init__(self, path, folder, name, table, limits):
        self.where, self.limits = f"{path}: setting {name}", limits
        self.folder, self.name, self.table = folder, name, table
        unknown = set(table) - KEYS
        if unknown:
            self.fail(f"there is no key {sorted(unknown)[0]}; keys: {', '.join(sorted(KEYS))}")
        self.kind = table.get("kind", "choice")
        if self.kind not in C_KIND:
            self.fail(f"kind is {self.kind}, not switch, whole, real or pipeline")
        for key in ["help"] + ["default"] * (self.kind != "pipeline"):
            if key not in table:
                self.fail(f"it has no {key}")
        self.choices = ["off", "on"] if self.kind == "switch" else table.get("choices", [])
        self.number, self.help = table.get("number"), table["help"].strip()
        self.id = "RT_" + table.get("id", name.upper())
        fields = table.get("field", name)
        self.fields = fields if isinstance(fields, list) else [fields]
        self.check()

    def fail(self, why):
        sys.exit(f"settings.py: {self.where}: {why}")

    def check(self):
        has_range = self.kind in ("whole", "real")
        if has_range != ("range" in self.table) or has_range == bool(self.choices):
            self.fail("a number has a range, anything else choices or kind")
        if len(self.choices) > 16:
            self.fail(f"{len(self.choices)} choices: shaders have a hexadecimal digit, for 16")
        if self.number is not None and not (isinstance(self.number, int) and self.number >= 0):
            self.fail(f"number is {self.number}, not a whole number from 0 on")
        for engine in set(self.engines()):
            value = self.default(engine)
            if self.choices and value not in self.choices:
                self.fail(f"default is {value}, not one of: {', '.join(self.choices)}")
            if has_range and not self.limit(0) <= value <= self.limit(1):
                self.fail(f"default is {value}, outside {self.limit(0):g} .. {self.limit(1):g}")

    def limit(self, end):
        """An end of the range as a number."""
        value = self.table["range"][end]
        while isinstance(value, str) and value in self.limits:
            value = self.limits[value]
        try:
            return float(value)
        except ValueError:
            self.fail(f"range: {value} is no number and no constant of renderer/march_params.h")

    def engines(self):
        realtime = () if self.number is None else ("realtime",)
        return self.table.get("engines", realtime if self.folder else MARCHES + realtime)

    def default(self, engine):
        value = self.table["default"]
        if isinstance(value, dict) and engine not in value:
            self.fail(f"it has no default of {engine}")
        return value[engine] if isinstance(value, dict) else value

    def row(self, engine):
        """In a C table of options."""
        value, text = self.default(engine), c_text(self.help)
        if self.choices:
            words = "".join(f'"{word}", ' for word in self.choices)
            return (f'CHOICE("{self.name}", {self.choices.index(value)}, '
                    f"((const char *const[]){{{words}NULL}}), {text})")
        least, most = self.table["range"]
        return f'{C_KIND[self.kind]}("{self.name}", {value}, {least}, {most}, {text})'

    def c_type(self):
        return self.table.get("type", C_TYPE[self.kind])

    def read(self, index, place=0):
        """Its value in C, for the field at a place of the list."""
        if self.kind == "real":
            return f"values[{index}]"
        if self.kind == "switch" or self.table.get("type") == "bool":
            return f"values[{index}] > {place}.0"
        number = f"(int)values[{index}]"
        return f"({self.table['type']}){number}" if "type" in self.table else number


def group(setting):
    """The heading of a setting in docs/settings.md: the folder's name in words."""
    return setting.folder.replace("_", " ") or "march"


def c_text(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def load(root):
    paths = [root / "renderer/march_settings.toml"]
    paths += sorted((root / "renderer/realtime").glob("*/settings.toml"))
    settings, limits = [], {}
    for path in (root / "renderer/march_params.h", root / "renderer/shaders/constants.h"):
        limits |= dict(re.findall(r"#define (NEPH_\w+) (\S+)", path.read_text()))
    for path in paths:
        folder = "" if path.parent.name == "renderer" else path.parent.name
        name = path.relative_to(root)
        try:
            tables = tomllib.loads(path.read_text())
        except tomllib.TOMLDecodeError as error:
            sys.exit(f"settings.py: {name}: {error}")
        settings += [Setting(name, folder, key, table, limits)
                     for key, table in tables.items()]
    known, numbers = {}, {}
    for setting in settings:
        if setting.name in known:
            setting.fail(f"{known[setting.name].where} is of the same name")
        known[setting.name] = setting
        if setting.number is not None and numbers.setdefault(setting.number, setting) != setting:
            setting.fail(f"{numbers[setting.number].where} has number {setting.number}, too; the "
                         f"next is {max(numbers) + 1}")
    return settings


def of_realtime(settings):
    return sorted((s for s in settings if s.number is not None), key=lambda s: s.number)


def of_pipeline(settings):
    return [s for s in settings if s.kind == "pipeline"]


def constants(settings):
    """The words of choices as names: of settings that share them the longest list."""
    lists = {}
    for setting in settings:
        if "constants" in setting.table:
            shorter, longer = sorted((lists.get(setting.table["constants"], []), setting.choices),
                                     key=len)
            if longer[:len(shorter)] != shorter:
                setting.fail(f"RT_{setting.table['constants']}_ are other words elsewhere: "
                             f"{', '.join(shorter)}")
            lists[setting.table["constants"]] = longer
    return lists


def constant_count(settings):
    """Of eight hexadecimal digits each."""
    return (len(of_realtime(settings)) + len(of_pipeline(settings)) + 7) // 8


def names(settings):
    """For GLSL and C: where each setting is in a view, and the numbers of its words."""
    rows = of_realtime(settings)
    all_numbers = rows + of_pipeline(settings)
    lines = ["// By renderer/settings.py of the files settings.toml.",
             "#ifndef NEPH_GENERATED_REALTIME_NAMES_H", "#define NEPH_GENERATED_REALTIME_NAMES_H"]
    lines += [f"#define {setting.id} {index}" for index, setting in enumerate(all_numbers)]
    lines += [f"#define RT_SETTING_COUNT {len(rows)}",
              f"#define RT_NUMBER_COUNT {len(all_numbers)}",
              f"#define RT_CHOICE_CONSTANT_COUNT {constant_count(settings)}", ""]
    for prefix, words in constants(all_numbers).items():
        lines += [f"#define RT_{prefix}_{word.upper()} {i}" for i, word in enumerate(words)] + [""]
    return "\n".join(lines + ["#endif", ""])


def members(rows):
    """Of a C struct: (setting, name of the member) with the help as its comment."""
    lines = []
    for setting, name in rows:
        comment = textwrap.wrap(setting.help, 88)
        lines += ["    /* " + "\n     * ".join(comment) + " */", f"    {setting.c_type()} {name};"]
    return lines


def header(settings):
    """The settings of each pass as C reads them."""
    rows = of_realtime(settings)
    folders = sorted({setting.folder for setting in rows} - {""})
    lines = ["/* By renderer/settings.py of the files settings.toml. */",
             "#ifndef NEPH_GENERATED_REALTIME_SETTINGS_H",
             "#define NEPH_GENERATED_REALTIME_SETTINGS_H", "", "#include <stdbool.h>", ""]
    for folder in folders:
        lines += [f"struct neph_rt_{folder}_settings {{",
                  *members((s, s.fields[0]) for s in rows if s.folder == folder), "};", ""]
    lines += ["/* By the folder of a pass; `shared`: that several passes read. Those of the march",
              " * are read into struct neph_march_params. */", "struct neph_rt_settings {"]
    lines += [f"    struct neph_rt_{folder}_settings {folder};" for folder in folders]
    return "\n".join(lines + ["};", "", "#endif", ""])


def reader(function, settings, index):
    """A C function that fills in the parameters of a march."""
    lines = [f"static void {function}(const double *values, struct neph_march_params *params)", "{"]
    heads = [head for head in CONVERTED if any(f.split(".")[0] == head
                                               for s in settings for f in s.fields)]
    lines += [f"    {CONVERTED[head][0]} {head};" for head in heads]
    for setting in settings:
        for place, field in enumerate(setting.fields if "field" in setting.table else []):
            target = field if field.split(".")[0] in CONVERTED else f"params->{field}"
            lines.append(f"    {target} = {setting.read(index(setting), place)};")
    lines += [f"    params->{head} = {CONVERTED[head][1]}({head});" for head in heads]
    return "\n".join(lines + ["}", ""])


def realtime_table(settings):
    rows = of_realtime(settings)
    lines = ["/* By renderer/settings.py of the files settings.toml. */",
             "const struct neph_option neph_rt_options[RT_SETTING_COUNT + 1] = {"]
    lines += [f"    {setting.row('realtime')}," for setting in rows]
    lines += ["    {.choices = gone},", "};", "",
              "const char *const neph_rt_option_groups[RT_SETTING_COUNT] = {"]
    lines += [f'    "{group(setting)}",' for setting in rows]
    lines += ["};", ""]
    lines += ["struct neph_rt_settings neph_rt_group_settings("
              "const struct neph_settings *settings)",
              "{", "    const double *values = settings->values;",
              "    return (struct neph_rt_settings){"]
    lines += [f"        .{setting.folder}.{setting.fields[0]} = {setting.read(setting.id)},"
              for setting in rows if setting.folder]
    return "\n".join(lines + ["    };", "}", ""])


def realtime_march(settings):
    """Those of the march, in C."""
    marched = [setting for setting in of_realtime(settings) if not setting.folder]
    return ("/* By renderer/settings.py of renderer/march_settings.toml. */\n" +
            reader("read_march", marched, lambda setting: setting.id))


def march_table(settings):
    """Options of the engines march*: those of all come first."""
    of_all = [s for s in settings if not s.folder and set(MARCHES) <= set(s.engines())]
    lines = ["/* By renderer/settings.py of renderer/march_settings.toml. */"]
    text = ""
    for engine in MARCHES:
        rest = [s for s in settings if not s.folder and s not in of_all and engine in s.engines()]
        prefix = f"OPTION_{engine.upper()}_"
        rows = of_all + rest
        if engine == "march":
            lines += ["enum {", *(f"    OPTION_{s.name.upper()}," for s in of_all),
                      "    OPTION_COUNT", "};"]
        else:
            lines += ["enum {", *(f"    {prefix}{s.name.upper()}{' = OPTION_COUNT' * (i == 0)},"
                                  for i, s in enumerate(rest)), "};"]
        lines += [f"static const struct neph_option options_of_{engine}[] = {{",
                  *(f"    {s.row(engine)}," for s in rows), "    {.name = NULL},", "};", ""]
        which = of_all if engine == "march" else rest
        text += reader(f"read_{engine}", which, lambda s, p=prefix, e=engine: (
            "OPTION_" if e == "march" else p) + s.name.upper())
    return "\n".join(lines) + "\n" + text


def shortcuts(settings):
    """(setting, member of struct neph_shortcuts), of a struct within it as "shadow.texels"."""
    return [(s, field.removeprefix("shortcuts.")) for s in settings for field in s.fields
            if field.startswith("shortcuts.")]


def shortcut_structs(settings):
    """For C: the shortcuts of a march."""
    rows = shortcuts(settings)
    inner = [(s, name.removeprefix("shadow.")) for s, name in rows if name.startswith("shadow.")]
    outer = [(s, name) for s, name in rows if "." not in name]
    lines = ["/* By renderer/settings.py of renderer/march_settings.toml. */",
             "#ifndef NEPH_GENERATED_MARCH_SHORTCUTS_H", "#define NEPH_GENERATED_MARCH_SHORTCUTS_H",
             "", "/* A shadow map of clouds. */", "struct neph_shadow_map {", *members(inner),
             "};", "",
             "/* Shortcuts through media, for speed. Zero: none, and the march keeps its bits. */",
             "struct neph_shortcuts {", *members(outer), "    struct neph_shadow_map shadow;", "};"]
    return "\n".join(lines + ["", "#endif", ""])


def shortcut_bits(settings):
    """For GLSL and C."""
    lines = ["// By renderer/settings.py of renderer/march_settings.toml."]
    lines += [f"#define NEPH_SHORTCUT_{s.name.upper()} {1 << s.table['bit']}u"
              for s in settings if "bit" in s.table]
    return "\n".join(lines + [""])


def shortcut_numbers(settings):
    return [(s, name) for s, name in shortcuts(settings) if s.kind == "real" and "bit" in s.table]


def frame_members(settings):
    """For the uniform Frame of GLSL: the numbers of shortcuts."""
    lines = ["// By renderer/settings.py of renderer/march_settings.toml."]
    return "\n".join(lines + [f"float {name};" for _, name in shortcut_numbers(settings)] + [""])


def shortcut_code(settings):
    """For C: the bits of shortcuts, their numbers in a frame, and their ranges. A number is 0 where
    it is not given, as are those of a switch that is off."""
    switches = {s.name: name for s, name in shortcuts(settings) if s.choices and "bit" in s.table}
    lines = ["/* By renderer/settings.py of renderer/march_settings.toml. */",
             "uint32_t neph_shortcuts_bits(const struct neph_shortcuts *shortcuts)", "{",
             "    uint32_t bits = 0u;"]
    for setting, name in shortcuts(settings):
        if "bit" in setting.table:
            least = f" > {setting.table['range'][0]}.0" if setting.kind == "real" else ""
            lines.append(f"    bits |= shortcuts->{name}{least} ? "
                         f"NEPH_SHORTCUT_{setting.name.upper()} : 0u;")
    lines += ["    return bits;", "}", "",
              "void neph_shortcuts_set_frame(const struct neph_shortcuts *shortcuts,",
              "                              struct neph_gpu_frame *frame)", "{"]
    lines += [f"    frame->{name} = (float)fmax({setting.table['range'][0]}, shortcuts->{name});"
              for setting, name in shortcut_numbers(settings)]
    lines += ["}", "",
              "static enum neph_status check_ranges(const struct neph_shortcuts *shortcuts,",
              "                                     struct neph_diag *diag)", "{",
              "    enum neph_status status = NEPH_OK;"]
    for setting, name in shortcuts(settings):
        if setting.kind in ("whole", "real"):
            word = "cloud_shadow" if name.startswith("shadow.") else setting.name
            switch = next((f" && shortcuts->{field}" for of, field in switches.items()
                           if (word + "_").startswith(of + "_")), "")
            is_given = "" if switch and "engines" not in setting.table else \
                f" && shortcuts->{name} != 0"
            least, most = setting.table["range"]
            lines += [f"    if (!status{switch}{is_given})",
                      f'        status = check_range("{setting.name}", shortcuts->{name}, {least}, '
                      f"{most}, diag);"]
    return "\n".join(lines + ["    return status;", "}", ""])


def digits(settings):
    """GLSL: constants of eight hexadecimal digits, and the one that has the digit of a number."""
    count = constant_count(settings)
    lines = ["// By renderer/settings.py of the files settings.toml."]
    lines += [f"layout(constant_id = RT_CHOICE_CONSTANT + {i}) const uint DIGITS_{i} = 0;"
              for i in range(count)]
    cases = " : ".join(f"(s) >> 3 == {i} ? DIGITS_{i}" for i in range(count - 1))
    return "\n".join(lines + [f"#define DIGITS_OF(s) ({cases} : DIGITS_{count - 1})", ""])


def capacity(settings):
    """For C: how many options the longest table has."""
    return ("/* By renderer/settings.py of the files settings.toml. */\n"
            f"#define NEPH_OPTIONS_MAX {max(len(of_realtime(settings)), LONGEST_OTHER)}\n")


def page(settings):
    """docs/settings.md"""
    lines = ["# Settings of the ray marchers and of `realtime`", "",
             "This page lists all settings of engine `realtime`, by pass. Those under *march* are",
             "also settings of `march` and `march_*`, or of the engines that the row names",
             "(`traced`: `march_traced`). Words: [glossary.md](glossary.md). Written by",
             "`renderer/settings.py . --docs` from the files `settings.toml`.", ""]
    for folder in [""] + sorted({setting.folder for setting in settings} - {""}):
        rows = [s for s in settings if s.folder == folder and s.kind != "pipeline"]
        if not rows:
            continue
        lines += [f"## {group(rows[0])}", "",
                  "| setting | default | values | what it is |", "| --- | --- | --- | --- |"]
        for setting in rows:
            default = setting.table["default"]
            if isinstance(default, dict):
                default = ", ".join(f"{engine} {value}" for engine, value in default.items())
            values = (", ".join(setting.choices) if setting.choices else
                      f"{setting.limit(0):g} .. {setting.limit(1):g}")
            engines = setting.table.get("engines")
            text = setting.help + (f" ({', '.join(engines)})" if engines else "")
            lines.append(f"| `{setting.name}` | {default} | {values} | {text} |")
        lines.append("")
    return "\n".join(lines)


def write(path, text):
    if not path.exists() or path.read_text() != text:  # else nothing is rebuilt
        path.write_text(text)


def main():
    root = pathlib.Path(sys.argv[1])
    settings = load(root)
    if sys.argv[2] == "--docs":
        sys.stdout.write(page(settings))
        return
    folder = pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (("capacity.h", capacity), ("realtime_names.h", names),
                       ("realtime_digits.glsl", digits),
                       ("realtime_settings.h", header), ("realtime_table.inc", realtime_table),
                       ("realtime_march.inc", realtime_march), ("march_table.inc", march_table),
                       ("march_shortcuts.h", shortcut_structs),
                       ("march_shortcut_bits.h", shortcut_bits),
                       ("march_frame.glsl", frame_members),
                       ("march_shortcuts.inc", shortcut_code)):
        write(folder / name, text(settings))


if __name__ == "__main__":
    main()
