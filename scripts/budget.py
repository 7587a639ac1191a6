#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints what a build, the tests and a first frame cost, one line each, beside the limits of
scripts/budgets.txt. Exit code 1: the program is too large. Times never fail, since machines differ.

  scripts/budget.py BUILD [TIMES_BEFORE TIMES_AFTER]

BUILD is the folder of the release build. The other two files hold what bash's `times` printed
before the tests and after them."""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

SCRIPTS = pathlib.Path(__file__).resolve().parent
EXACT = "bytes"
IN_SECONDS = {"s": 1.0, "min": 60.0, "ms": 0.001}
FRAME = ["cloud_below", "--scattering=single", "--size=64x36", "--quiet"]
MARCH = ["--engine=march"]
OURS = ["--engine=realtime", "--preset=ours"]


def read_budgets(text):
    """{name: (limit, unit, what is measured)}; a time and its limit are in the unit."""
    budgets = {}
    for number, line in enumerate(text.split("\n"), 1):
        fields = line.split("#")[0].split(None, 3)
        if not fields:
            continue
        if len(fields) != 4 or fields[2] not in {EXACT, "%", *IN_SECONDS} or fields[0] in budgets:
            raise ValueError(f"budgets.txt, line {number}: '{line}': give a new name, a limit, "
                             f"a unit ({', '.join(IN_SECONDS)}, %, {EXACT}) and what is measured")
        budgets[fields[0]] = (float(fields[1]), fields[2], fields[3])
    return budgets


def read_command_times(lines):
    """Seconds of each output's last build, {output: seconds}, of the log of timed_command.

    A line is: output, process id of the shell, command, user seconds, system seconds. Commands of
    one build of an output share the shell."""
    last = {}
    for line in lines:
        fields = line.replace(",", ".").rsplit(None, 4)
        if len(fields) != 5:
            continue  # of a build that was interrupted
        output, shell, _, user, system = fields
        before = last.get(output, (shell, 0.0))
        seconds = before[1] if before[0] == shell else 0.0
        last[output] = (shell, seconds + float(user) + float(system))
    return {output: seconds for output, (_, seconds) in last.items()}


def build_times(build):
    """Seconds by budget; None: some of it was not built since there is a log."""
    log = build / "command_times.txt"
    times = read_command_times(log.read_text(errors="replace").split("\n")) if log.exists() else {}
    done = subprocess.run(["ninja", "-C", str(build), "-t", "targets", "all"], capture_output=True,
                          text=True, check=True)
    return sum_by_budget(done.stdout.split("\n"), {
        os.path.relpath(output, build): seconds for output, seconds in times.items()})


def sum_by_budget(targets, times):
    """`targets`: lines of `ninja -t targets all`; `times`: seconds by output."""
    outputs = {"build_shaders": {}, "build_c": {}, "build_tests": {}}
    for line in targets:
        name, _, rule = line.rpartition(": ")
        is_shader = rule == "CUSTOM_COMMAND" and name.endswith(".comp.inc")
        is_c = rule.startswith(("C_COMPILER__", "CXX_COMPILER__"))
        if name.startswith("/") or not (is_shader or is_c):
            continue
        kind = "build_shaders" if is_shader else "build_c"
        if name.startswith("tests/"):
            kind = "build_tests"
        outputs[kind][name] = times.get(name)
    sums = {kind: None if not seconds or None in seconds.values() else sum(seconds.values())
            for kind, seconds in outputs.items()}
    has_shaders = sums["build_shaders"] is not None
    sums["slowest_shader"] = max(outputs["build_shaders"].values()) if has_shaders else None
    return sums


def read_shell_times(text):
    """Seconds of the children of a shell, of what bash's `times` prints: its second line."""
    seconds = 0.0
    for time in text.replace(",", ".").split("\n")[1].split():
        minutes, rest = time.rstrip("s").split("m")
        seconds += 60 * float(minutes) + float(rest)
    return seconds


def processor_seconds(commands, environment=None):
    """Of commands that run at once, each; seconds for all of them."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    children = [subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.PIPE, text=True, env=environment)
                for command in commands]
    for child in children:
        complaint = child.communicate()[1]
        if child.returncode != 0:
            raise subprocess.CalledProcessError(child.returncode, child.args, stderr=complaint)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def reference_seconds(copies):
    """Seconds for a fixed file of C, of each of the copies that are compiled at once."""
    function = ("double f%d(const double *x, int n) {{ double s = 0; for (int i = 0; i < n; i++) "
                "{{ s += x[i] > %d ? x[i] * s : x[n - i - 1] / (1 + s * s); "
                "if (s > %d) s = f%d(x + 1, n - 1) - s; }} return s; }}\n").replace("{{", "{")
    function = function.replace("}}", "}")
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder) / "reference.c"
        source.write_text("double f0(const double *x, int n) { return n > 0 ? x[0] : 0; }\n" +
                          "".join(function % (i, i, 2 * i, i - 1) for i in range(1, 200)))
        return processor_seconds(
            [["cc", "-O2", "-c", str(source), "-o", f"{folder}/{core}.o"]
             for core in range(copies)]) / copies


def first_frames(neph):
    """Milliseconds of processor time of processes that render a frame, with caches of their own;
    of three with full caches, the shortest."""
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, XDG_CACHE_HOME=f"{folder}/cache",
                           MESA_SHADER_CACHE_DIR=f"{folder}/mesa")

        def render(engine):
            command = [str(neph), "render", *FRAME, *engine, f"--output={folder}"]
            return processor_seconds([command], environment)

        cold = render(OURS)
        ours = min(render(OURS) for _ in range(3))
        render(MARCH)
        return {"first_march": min(render(MARCH) for _ in range(3)), "first_ours": ours,
                "first_ours_cold": cold}


def program_name():
    """Name of the program's limit: its size depends on the compiler."""
    done = subprocess.run(["cc", "-dumpversion"], capture_output=True, text=True, check=True)
    return f"program_gcc{done.stdout.split('.')[0].strip()}"


def judge(budgets, measured, references):
    """A line for each budget, and the names of those that are over. Times are scaled to the
    machine of the limits; `references`: seconds of the reference work here, by their names."""
    slack = 1 + budgets["slack"][0] / 100
    lines, over = [], []
    for name, (limit, unit, what) in budgets.items():
        if name in ("reference_all", "reference_one", "slack"):
            continue
        value = measured.get(name)
        if value is None:
            lines.append(f"  {name}: not measured in this run, limit {limit:.10g} {unit}: {what}")
            continue
        if unit != EXACT:
            reference = "reference_one" if name.startswith("first_") else "reference_all"
            value *= budgets[reference][0] / references[reference] / IN_SECONDS[unit]
        is_over = value > (limit if unit == EXACT else limit * slack)
        if is_over:
            over.append(name)
        shown = f"{value:.0f}" if value >= 100 else f"{value:.3g}"
        mark, end = ("!", "  ** OVER ITS LIMIT **") if is_over else (" ", "")
        lines.append(f"{mark} {name}: {shown} {unit}, limit {limit:.10g}: {what}{end}")
    return lines, over


def main(arguments):
    if len(arguments) not in (1, 3):
        print(__doc__, file=sys.stderr)
        return 64
    build = pathlib.Path(arguments[0]).resolve()
    budgets = read_budgets((SCRIPTS / "budgets.txt").read_text())
    measured = build_times(build)
    if len(arguments) == 3:
        before, after = (read_shell_times(pathlib.Path(name).read_text()) for name in arguments[1:])
        measured["tests"] = after - before
    program = program_name()
    measured[program] = (build / "neph").stat().st_size
    if program not in budgets:
        print(f"{program}: {measured[program]} bytes; scripts/budgets.txt has no limit for it.")
    try:
        measured.update(first_frames(build / "neph"))
    except subprocess.CalledProcessError as error:
        print(f"no first frames: {error}\n{error.stderr}", file=sys.stderr)
    # Tasks slow each other on the threads of a core: one process renders a frame, builds and tests
    # run on all cores.
    references = {"reference_one": reference_seconds(1),
                  "reference_all": reference_seconds(os.cpu_count() or 1)}
    lines, over = judge(budgets, measured, references)
    one, every = (seconds / budgets[name][0] for name, seconds in references.items())
    print(f"Budgets of scripts/budgets.txt. Times here are divided by {every:.2f}, those of first "
          f"frames by {one:.2f}: the reference work takes so much longer than there.")
    print("\n".join(lines))
    if over:
        print(f"Over: {', '.join(over)}. Mend it, or raise its limit in scripts/budgets.txt and "
              "say there why.")
    return 1 if any(budgets[name][1] == EXACT for name in over) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
