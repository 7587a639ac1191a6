#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""manual.py NEPH FOLDER COMPLETION: man pages of neph and of each verb, and bash completion, out of
their --help."""
import pathlib
import re
import subprocess
import sys

OPTION = re.compile(r"^  (?:-(?P<letter>\S), |    )(?P<name>--\S+)(?: +(?P<help>.*))?$")
TEXT_COLUMN = 29  # of the texts of options, as harness/help.c has it


def ask(neph, *words):
    done = subprocess.run([neph, *words], capture_output=True, text=True, check=True)
    return done.stdout


def listed(text):
    """The names and summaries of a hand-made list, as of verbs."""
    return re.findall(r"^  (\w+) +(.*)$", text.split("\n\nExamples")[0], re.MULTILINE)


class Verb:
    """The help of one: usages, lines before the options, options, lines behind them."""

    def __init__(self, neph, *words):
        self.name = " ".join(words)
        self.usages, self.before, self.options, self.after = [], [], [], []
        for line in ask(neph, *words, "--help").splitlines():
            option = OPTION.match(line)
            if re.match(r"Usage: |  or:  ", line):
                self.usages.append(line[7:].strip())
            elif option:
                self.options.append([option["letter"], option["name"], option["help"] or ""])
            elif self.options and not self.after and line.startswith(TEXT_COLUMN * " "):
                self.options[-1][2] = f"{self.options[-1][2]} {line.strip()}".strip()
            elif line or self.after or not self.options:  # none between groups of options
                (self.after if self.options else self.before).append(line)

    def words(self):
        for letter, name, _ in self.options:
            yield from (["-" + letter] if letter else []) + [name.split("=")[0]]


# ---- the page ------------------------------------------------------------------------------------


def roff(text):
    for plain, escape in ("\\", "\\e"), ("-", "\\-"), ("'", "\\(aq"), ("`", "\\(ga"):
        text = text.replace(plain, escape)
    return "\\&" + text if text.startswith((".", "\\(aq")) else text


def paragraphs(lines):
    """Indented lines stay lines; the others are paragraphs."""
    literal = False
    for line in lines:
        if literal != line.startswith("  ") and line:
            literal = not literal
            yield ".RS 2\n.nf" if literal else ".fi\n.RE"
        yield roff(line.strip()) if line else ".PP"
    if literal:
        yield ".fi\n.RE"


def described(term, text):
    return f".TP\n.B {roff(term)}\n{roff(text)}"


def head(name, version, summary):
    yield f'.TH {roff(name.upper())} 1 "" "{version}" "Nephelometer"'
    yield f".SH NAME\n{roff(name)} \\- {roff(summary)}"


def top_page(version, top, verbs):
    summary, codes = re.search(r"\n(.*)\n\n(?:.*\n)*(Exit codes: (?:.+\n)+)", top).groups()
    yield from head("neph", version, summary.strip().rstrip("."))
    yield ".SH SYNOPSIS\n.B neph\n.I VERB\n.RI [ ARGUMENT ...]"
    yield ".SH VERBS\nEach has a page, such as\n.BR neph\\-compare (1)."
    yield from (described(f"neph {name}", summary) for name, summary in verbs)
    yield f".SH EXIT STATUS\n{roff(' '.join(codes.split()).removeprefix('Exit codes: '))}"


def verb_page(version, verb, summary):
    yield from head(page_name(verb.name), version, summary)
    yield ".SH SYNOPSIS"
    yield from (f".B {roff(usage)}\n.br" for usage in verb.usages)
    yield ".SH DESCRIPTION"
    yield from paragraphs(verb.before)
    if verb.options:
        yield ".SH OPTIONS"
    for letter, name, text in verb.options:
        yield described(", ".join((["-" + letter] if letter else []) + [name]), text)
    notes, _, examples = "\n".join(verb.after).partition("\nExample")
    if notes.strip():
        yield ".SH NOTES"
        yield from paragraphs(notes.strip("\n").splitlines())
    if examples:
        yield ".SH EXAMPLES"
        yield from paragraphs(examples.splitlines()[1:])
    yield ".SH EXIT STATUS\nSee\n.BR neph (1)."


def page_name(verb):
    return "-".join(["neph", *verb.split()])


# ---- completion ----------------------------------------------------------------------------------

COMPLETION = """# bash completion of neph(1), made by scripts/manual.py.
_neph()
{
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} words=
    local verb=${COMP_WORDS[1]}
    [[ $verb == study && $COMP_CWORD -gt 2 ]] && verb="study ${COMP_WORDS[2]}"
    if [[ $before == -e || $before == --engine ]]; then
        words="@engines@"
    elif [[ $COMP_CWORD -eq 1 ]]; then
        words="@verbs@"
    elif [[ $word == -* ]]; then
        case $verb in
@options@
        esac
    elif [[ $before != -* ]]; then
        case $verb in
            study) words="@kinds@" ;;
            engines) words="@engines@" ;;
            @with_scenes@) words="@scenes@" ;;
        esac
    fi
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o default -F _neph neph
"""


def completion(neph, top, kinds, verbs):
    folder = pathlib.Path(__file__).parents[1] / "scenes"
    scenes = sorted(path.stem for kind in ("catalog", "stress")
                    for path in (folder / kind).glob("*.yaml"))
    engines = re.findall(r'"engine": "(\w+)"', ask(neph, "scenes", scenes[0], "--json"))
    parts = {
        "verbs": " ".join(name for name, _ in listed(top)),
        "kinds": " ".join(name for name, _ in kinds),
        "engines": " ".join(engines),
        "scenes": " ".join(scenes),
        "with_scenes": " | ".join(f'"{verb.name}"' for verb in verbs
                                  if "SCENE" in str(verb.usages)),
        "options": "\n".join(f'            "{verb.name}") words="{" ".join(verb.words())}" ;;'
                             for verb in verbs),
    }
    return re.sub(r"@(\w+)@", lambda part: parts[part[1]], COMPLETION)


def main(neph, folder, completion_path):
    top, kinds = ask(neph, "--help"), listed(ask(neph, "study", "--help"))
    version = ask(neph, "--version").strip()
    summaries = {}  # of pages of verbs; a kind of study is below its verb
    for name, summary in listed(top):
        summaries[name] = summary
        if name == "study":
            summaries |= {f"study {kind}": text for kind, text in kinds}
    verbs = {name: Verb(neph, *name.split()) for name in summaries}
    pages = {"neph": top_page(version, top, summaries.items())} | {
        page_name(name): verb_page(version, verbs[name], summaries[name]) for name in verbs}
    folder = pathlib.Path(folder)
    folder.mkdir(exist_ok=True)
    for path in set(folder.glob("*.1")) - {folder / f"{name}.1" for name in pages}:
        path.unlink()  # of a verb that is no more
    for name, lines in pages.items():
        (folder / f"{name}.1").write_text("\n".join(lines) + "\n")
    del verbs["study"]
    pathlib.Path(completion_path).write_text(completion(neph, top, kinds, verbs.values()))


if __name__ == "__main__":
    main(*sys.argv[1:])
