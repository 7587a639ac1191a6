#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Nightly runs by Slurm: by day against scripts with the names of its commands, which keep a queue;
by night against a real Slurm on loopback, with a node that is killed in the middle of a job."""
import getpass
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import time
import unittest

import night
from neph_case import NephCase

# sbatch queues jobs, each squeue runs one job of the queue; all record their arguments. With HOLD
# set no job starts; with LOSE the jobs of arrays end without having run.
SLURM = r"""#!/bin/sh
queue=${0%/*}/queue
printf '%s' "${0##*/}" >>"$queue/told"
printf ' <%s>' "$@" >>"$queue/told"
echo >>"$queue/told"
case ${0##*/} in
scontrol) echo "MaxArraySize            = 3" ;;
scancel) rm -f "$queue"/[0-9]* ;;
sbatch)
    number=$(($(ls "$queue" | wc -l)))
    array=0-0
    for word; do
        case $word in --array=*) array=${word#--array=} ;; esac
    done
    case $LOSE$word in 1eval*) word='exit 1' ;; esac
    echo "sbatch: a warning of this cluster"
    for task in $(seq "${array%%-*}" "$(echo "${array#*-}" | sed 's/%.*//')"); do
        printf 'SLURM_ARRAY_TASK_ID=%s\n%s\n' "$task" "$word" >"$queue/$((1000 + number))-$task"
    done
    echo "$number;loopback"
    ;;
squeue)
    [ -n "$HOLD" ] || for job in "$queue"/[0-9]*; do
        [ ! -e "$job" ] || sh "$job" >"$queue/said" 2>&1
        rm -f "$job"
        break
    done
    for job in "$queue"/[0-9]*; do [ ! -e "$job" ] || echo PENDING; done
    ;;
esac
"""


class Nights(NephCase):
    in_folder = True  # in which a database with a relative path is created

    def setUp(self):
        super().setUp()
        self.environment = {**os.environ, "NEPH_STORE_INDEX": str(self.folder / "index")}

    def neph(self, *arguments, code=0, output="out", **variables):
        done = super().neph(*arguments, "-o", self.folder / output, code=None,
                            surroundings=self.environment, **variables)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr + self.logs(output))
        return done

    def send(self, **variables):
        """Starts the command in the background."""
        return self.start(*self.SENT, "-o", self.folder / "out",
                          **{**self.environment, **variables})

    def logs(self, output):
        logs = sorted((self.folder / output / "nightly/logs").glob("slurm-*.log"))
        return "".join(f"\n== {log.name}\n{log.read_text()}" for log in logs)

    def numbers(self, output):
        """The content of a store without times, hosts and dates."""
        document = self.json("store", "export", output=output)
        nights = [{key: night[key] for key in ("night", "plan", "revision", "program", "verdict",
                                               "measurements", "frames")}
                  | {"steps": [(step["name"], step["outcome"], step["size"])
                               for step in night["steps"]]} for night in document["nights"]]
        for row in nights:
            row["measurements"] = [m for m in row["measurements"] if m["kind"] != "timed"]
        return nights, [(job["key"], job["scene"], job["settings"]) for job in document["jobs"]]

    def assert_stores_are_equal(self):
        local, sent = self.numbers("local"), self.numbers("out")
        self.assertTrue(local[0][-1]["measurements"] and local[1])
        self.assertEqual(sent, local)
        self.neph("store", "check")
        # No host has opened a database in the store, and no file of the jobs is left.
        self.assertFalse((self.folder / "out/store/index").exists())
        self.assertFalse((self.folder / "out/nightly/jobs").exists())


class Queue(Nights):
    """Without a Slurm."""

    def setUp(self):
        super().setUp()
        self.queue = self.folder / "bin/queue"
        self.queue.mkdir(parents=True)
        for name in ("sbatch", "squeue", "scancel", "scontrol"):
            path = self.folder / "bin" / name
            path.write_text(SLURM)
            path.chmod(0o755)
        for tool in ("sh", "ls", "seq", "sed", "wc", "rm"):  # and no external renderer
            (self.folder / "bin" / tool).symlink_to(shutil.which(tool))
        self.environment["PATH"] = str(self.folder / "bin")

    def told(self, command):
        lines = (self.queue / "told").read_text().splitlines()
        return [re.findall(r"<(.*?)>(?= <|$)", line) for line in lines
                if line.startswith(f"{command} ")]

    SENT = ["nightly", "--only", "failure fog_none", "--once", "--executor", "slurm"]

    def test_a_run_by_jobs_equals_one_process(self):
        self.neph(*self.SENT[:-2], "-q", code=1, output="local")
        done = self.neph(*self.SENT, code=1)
        self.assertIn("compared nothing", done.stdout)
        self.assertIn("failure fog_none", done.stderr)  # progress, while it waits
        self.assertEqual(done.stdout, (self.folder / "out/nightly/summary.txt").read_text())
        self.assert_stores_are_equal()
        task, report = self.told("sbatch")
        self.assertIn("--array=0-0", task)
        self.assertIn("--requeue", task)
        self.assertIn("--dependency=afterany:1", report)
        names = {word for words in (task, report) for word in words if "--job-name" in word}
        self.assertEqual(len(names), 1)

    def send_and_leave_waiting(self, asked):
        """Starts the command, and returns after it has queried its jobs `asked` times."""
        child = self.send(HOLD="1")
        while not (self.queue / "told").exists() or len(self.told("squeue")) < asked:
            self.assertIsNone(child.poll())
            time.sleep(0.02)
        return child

    def test_lost_and_cancelled_jobs(self):
        child = self.send_and_leave_waiting(1)
        child.kill()
        child.wait()
        asked = len(self.told("squeue"))
        child = self.send_and_leave_waiting(asked + 2)
        self.assertEqual(len(self.told("sbatch")), 2)  # it waits for the first run's jobs
        refused = self.neph(*self.SENT[:-2], code=69)  # here and by jobs at once
        self.assertIn("jobs named neph-", refused.stderr)
        refused = self.neph("nightly", "--only", "ridge_far", "--once", "--executor", "slurm",
                            code=69, HOLD="1")
        self.assertIn("another night", refused.stderr)
        self.interrupt(child)
        self.assertEqual(len(self.told("scancel")), 1)
        self.assertEqual([job.name for job in self.queue.glob("[0-9]*")], [])
        # The step's job is lost, and the report states it.
        done = self.neph(*self.SENT, code=1, LOSE="1")
        [step] = json.loads((self.folder / "out/nightly/nightly.json").read_text())["steps"]
        self.assertEqual((step["done"], step["outcome"]), (False, "failed"), done.stderr)
        self.assertIn("ended without a result", step["reason"])

    def test_unsendable_runs_are_refused(self):
        sent = self.SENT
        self.assertIn("NEPH_STORE_INDEX=/", self.neph(*sent, code=64, NEPH_STORE_INDEX="").stderr)
        self.assertIn("NEPH_STORE_INDEX=/", self.neph(*sent, code=64, NEPH_STORE_INDEX="a").stderr)
        self.assertIn("gpu=FEATURE", self.neph(*sent, code=64, NEPH_VULKAN_DEVICE="geforce").stderr)
        self.assertIn("no such key", self.neph(*sent, "--slurm", "hosts=a", code=64).stderr)
        self.assertIn("local or slurm", self.neph(*sent, "--executor", "dask", code=64).stderr)
        self.assertIn("has no jobs of this nightly run",
                      self.neph(*sent, "--report", code=64).stderr)
        self.assertIn("has no jobs of this nightly run",
                      self.neph(*sent, "--step", "failure fog_none", code=64).stderr)
        without = self.neph(*sent, code=69, PATH="/nonexistent")
        self.assertIn("apt-get install slurm-client", without.stderr)


CONFIGURATION = """
ClusterName=loopback
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={ports[0]}
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge.sock
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmctldLogFile={folder}/log/slurmctld.log
SlurmdLogFile={folder}/log/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
MailProg=/bin/true
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc={folder}/log/jobcomp.txt
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
ReturnToService=2
KillWait=2
SlurmdTimeout=10
MaxArraySize=3
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1 Feature=quiet
PartitionName=render Nodes=n1,n2 Default=YES MaxTime=60 State=UP
"""
DAEMONS = ("munged", "slurmctld", "slurmd")
PATH = os.environ["PATH"] + ":/usr/sbin"
MISSING = [name for name in DAEMONS if not shutil.which(name, path=PATH)]


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [opened.getsockname()[1] for opened in sockets]
    for opened in sockets:
        opened.close()
    return ports


@night.of_the_night
@unittest.skipIf(MISSING, f"no {', '.join(MISSING)}: apt-get install slurm-wlm munge")
class Loopback(Nights):
    """A cluster of two nodes on this host, all processes of this user."""

    def setUp(self):
        super().setUp()
        self.cluster = self.folder / "cluster"
        for name in ("state", "log", "spool.n1", "spool.n2"):
            (self.cluster / name).mkdir(parents=True)
        configuration = self.cluster / "slurm.conf"
        configuration.write_text(CONFIGURATION.format(
            ports=free_ports(3), user=getpass.getuser(), folder=self.cluster,
            host=socket.gethostname().split(".")[0]))
        self.environment |= {"SLURM_CONF": str(configuration),
                             "PATH": PATH}
        self.addCleanup(self.stop)
        self.start()

    def start(self):
        key = self.cluster / "key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(1024))
        at = self.cluster
        self.daemon("munged", "--force", f"--key-file={key}", f"--socket={at}/munge.sock",
                    f"--pid-file={at}/munged.pid", f"--log-file={at}/log/munged.log",
                    f"--seed-file={at}/munged.seed", "--num-threads=2")
        self.daemon("slurmctld")
        for node in ("n1", "n2"):
            self.daemon("slurmd", "-N", node)
        self.wait(self.is_idle)

    def is_idle(self):
        return self.ask("sinfo", "-h", "-N", "-o", "%T").split() == ["idle", "idle"]

    def daemon(self, *words):
        done = subprocess.run(words, env=self.environment, capture_output=True, text=True,
                              timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr + self.cluster_logs())

    def cluster_logs(self):
        return "".join(log.read_text(errors="replace") for log in self.cluster.glob("log/*.log"))

    def ask(self, *words):
        return subprocess.run(words, env=self.environment, capture_output=True, text=True,
                              timeout=60).stdout

    def wait(self, condition, seconds=120):
        until = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), until, self.logs("out") + self.cluster_logs())
            time.sleep(0.05)

    def processes(self, *variables):
        """Numbers of the processes with all of these in their environment."""
        found = []
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                environment = (process / "environ").read_bytes().split(b"\0")
                if all(variable.encode() in environment for variable in variables):
                    found.append(int(process.name))
            except OSError:  # it has ended, or belongs to another user
                pass
        return [number for number in found if number != os.getpid()]

    def kill(self, numbers):
        for number in numbers:
            try:
                os.kill(number, signal.SIGKILL)
            except ProcessLookupError:
                pass

    def stop(self):
        """Stops all daemons and their children: their environment names this cluster."""
        ours = f"SLURM_CONF={self.environment['SLURM_CONF']}"
        until = time.monotonic() + 20
        while self.processes(ours) and time.monotonic() < until:
            self.kill(self.processes(ours))
            time.sleep(0.1)

    def kill_node(self, node):
        """Kills its daemon, then the processes that watch its jobs and would report, and then the
        jobs."""
        daemon = int((self.cluster / f"slurmd.{node}.pid").read_text())
        jobs = self.processes(f"SLURM_CONF={self.environment['SLURM_CONF']}",
                              f"SLURMD_NODENAME={node}")
        parents = {int(re.search(r"^PPid:\t(\d+)", status, re.MULTILINE)[1]) for status in
                   (pathlib.Path(f"/proc/{job}/status").read_text() for job in jobs)}
        self.kill([daemon])
        self.kill(parent for parent in parents if parent > 1 and "slurmstepd" in
                  pathlib.Path(f"/proc/{parent}/comm").read_text())
        self.kill(jobs)

    STEPS = ["nightly", "--only", "failure fog_none", "--only", "failure ridge_far", "--only",
             "speed voxel_grid"]
    SLURM = ["--size", "32x18", "--executor", "slurm", "--slurm", "partition=render", "--slurm",
             "timing=quiet", "--slurm", "arguments=--time=10"]
    SENT = [*STEPS, *SLURM]

    def done(self):
        """The time at which each step with output was finished."""
        nightly = self.folder / "out/nightly"
        return {path.stem: (nightly / "logs" / f"{path.stem}.log").stat().st_mtime_ns
                for path in nightly.glob("jobs/*_*.json")}

    def lose_a_node(self):
        """Kills n1 in the middle of a step, with all its processes."""
        child = self.send()
        self.addCleanup(child.kill)
        self.wait(lambda: self.processes("SLURMD_NODENAME=n1", "NEPH_STORE_INDEX=none",
                                         f"SLURM_CONF={self.environment['SLURM_CONF']}"))
        self.kill_node("n1")
        self.wait(lambda: self.ask("sinfo", "-h", "-n", "n1", "-o", "%T").startswith("down"))
        # Slurm keeps the step for later, and the report waits for it.
        self.wait(lambda: "PENDING BeginTime" in self.ask("squeue", "-h", "-o", "%T %r"))
        self.interrupt(child)
        return self.done()

    def test_a_run_survives_the_loss_of_a_node(self):
        self.neph(*self.STEPS, *self.SLURM[:2], "-q", code=1, output="local")
        done = self.lose_a_node()
        self.assertIn(len(done), (1, 2), self.logs("out"))  # on n2, which is still running
        sent = self.neph(*self.SENT, code=1)
        for step, when in done.items():  # finished steps do not run again
            log = self.folder / f"out/nightly/logs/{step}.log"
            self.assertEqual(log.stat().st_mtime_ns, when)
        self.assertIn("Steps: 3 of 3, 1 once more", sent.stdout)
        self.assert_stores_are_equal()
        self.assert_durations_are_of_the_marked_node()

    def assert_durations_are_of_the_marked_node(self):
        """The other node is back, idle, and the first of the two."""
        self.daemon("slurmd", "-N", "n1")
        self.wait(self.is_idle)
        self.neph("nightly", "--only", "speed voxel_grid", "--once", *self.SLURM, code=1)
        jobs = [dict(word.split("=", 1) for word in line.split() if "=" in word)
                for line in (self.cluster / "log/jobcomp.txt").read_text().splitlines()]
        tasks = [job for job in jobs if "ArrayTaskId" in job]
        self.assertEqual((tasks[-1]["NodeList"], tasks[-1]["JobState"]), ("n2", "COMPLETED"))
        self.assertEqual(jobs[-1]["NodeList"], "n1")  # the report runs on any node


if __name__ == "__main__":
    unittest.main()
