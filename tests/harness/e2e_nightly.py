#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Nightly runs of an operator: first, accepted, killed, two at once, and after a change."""
import json
import os
import pathlib
import random
import signal
import sqlite3
import time
import unittest
import xml.etree.ElementTree

import neph_case
import night

# Two scenarios of the stress tests, which take a second or two each; and a fog without external
# renderers, which are not in this PATH.
QUICK = ["nightly", "--only", "failure ridge_far", "--only", "failure fog_none", "-q", "--once"]
FOG = ["nightly", "--only", "catalog height_fog_down", "--size", "32x18", "-q", "--once"]
LONELY = {"PATH": "/nonexistent"}


class Nightly(neph_case.NephCase):
    def neph(self, *arguments, **expected):
        return super().neph(*arguments, "-o", self.folder, **expected)

    def start(self, *arguments, **environment):
        return super().start(*arguments, "-o", self.folder, **environment)

    def data(self):
        return json.loads((self.folder / "nightly/nightly.json").read_text())

    def accept(self, *arguments):
        return self.neph("baseline", "accept", "--why", "looked at", *arguments)

    def kill_a_run(self):
        child = self.start(*QUICK)
        logs = self.folder / "nightly/logs"  # the second step has begun
        self.wait_until(lambda: len(list(logs.glob("*.log"))) >= 2, child)
        self.neph(*QUICK, code=69, said="another nightly run is working")  # one at a time
        page = json.loads((self.folder / "nightly/report/data.json").read_text())
        self.assertEqual((page["state"], [step["outcome"] for step in page["steps"]].count("done")),
                         ("running", 1))
        child.kill()
        child.wait()

    @night.of_the_night
    def test_an_interrupted_run_is_reported(self):
        child = self.start(*QUICK)
        logs = self.folder / "nightly/logs"
        self.wait_until(lambda: len(list(logs.glob("*.log"))) >= 2, child)
        self.interrupt(child)
        page = json.loads((self.folder / "nightly/report/data.json").read_text())
        self.assertEqual(page["state"], "interrupted")

    def test_a_killed_run_resumes(self):
        self.kill_a_run()
        first = self.neph(*QUICK, code=1)
        self.assertEqual((self.data()["night"], self.data()["resumed"]), (1, True))
        self.assertEqual([step["done"] for step in self.data()["steps"]], [True, True])
        self.assertIn("compared nothing", first.stdout)
        self.assertIn("neph baseline accept", first.stdout)
        self.accept()
        second = self.neph(*QUICK)
        self.assertEqual(len(second.stdout.splitlines()), 1)  # one paragraph
        self.assertIn(f"{self.data()['compared']} comparisons with run 1", second.stdout)
        data = self.data()
        self.assertEqual((data["passes"], data["new"], data["findings"]), (True, 0, []))
        self.assertEqual(data["compared"], len(data["series"]))
        self.assertGreater(data["compared"], 4)
        self.assertEqual({row["floor"] for row in data["series"]}, {0.005})
        suite = xml.etree.ElementTree.parse(self.folder / "nightly/junit.xml").getroot()
        self.assertEqual((int(suite.get("tests")), suite.get("failures")),
                         (data["compared"], "0"))
        self.assertEqual(len(suite.findall("testcase")), data["compared"])
        self.assertEqual(second.stdout, (self.folder / "nightly/summary.txt").read_text())
        self.assert_the_store_knows_both()

    def assert_the_store_knows_both(self):
        document = json.loads(self.neph("store", "export").stdout)
        nights = document["nights"]
        self.assertEqual([row["verdict"] for row in nights], ["nothing compared", "pass"])
        self.assertEqual(*[[(m["series"], m["value"]) for m in row["measurements"]]
                           for row in nights])
        keys = {job["key"] for job in document["jobs"]}
        # Frames are stored under the program that made them, and have a device.
        self.assertEqual({len(row["build"]) for row in document["environments"]}, {16})
        self.assertNotIn("", [row["device"] for row in document["environments"]])
        self.assertTrue(keys and set(nights[0]["frames"]) == keys)
        [accepted] = document["acceptances"]
        self.assertEqual((accepted["night"], accepted["series"], accepted["why"]),
                         (1, "*", "looked at"))
        self.neph("store", "check")
        self.neph("store", "gc", "--limit", "0", "--spare-hours", "0", code=1)  # it is a baseline
        self.assertEqual(keys, {job["key"] for job in
                                json.loads(self.neph("store", "export").stdout)["jobs"]})

        self.assert_a_database_of_before_is_taken_over()

    def assert_a_database_of_before_is_taken_over(self):
        """A schema from before values had frames."""
        def numbers():
            document = json.loads(self.neph("store", "export").stdout)
            return [[(m["series"], m["value"]) for m in row["measurements"]]
                    for row in document["nights"]]
        before = numbers()
        database = sqlite3.connect(self.folder / "store/index/neph.sqlite")
        database.execute("ALTER TABLE measurements DROP COLUMN frame")
        database.execute("DROP TABLE night_scenes")
        database.execute("PRAGMA user_version = 1")
        database.commit()
        database.close()
        self.assertEqual(numbers(), before)
        database = sqlite3.connect(self.folder / "store/index/neph.sqlite")
        self.assertEqual(database.execute("PRAGMA user_version").fetchone(), (3,))
        self.assertEqual(database.execute("SELECT DISTINCT frame FROM measurements").fetchall(),
                         [("",)])
        database.close()

    def kill_processes_in(self, folder):
        """Returns whether there was such a process."""
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if str(folder).encode() in (process / "cmdline").read_bytes().split(b"\0"):
                    os.kill(int(process.name), signal.SIGKILL)
                    return True
            except OSError:  # the process has ended
                pass
        return False

    def kill_the_second_run(self):
        child = self.start(*FOG[:-1], **LONELY)
        self.wait_until(lambda: self.kill_processes_in(self.folder / "nightly/again"), child)
        said, _ = child.communicate(timeout=300)
        self.assertEqual(child.returncode, 1, said)
        self.assertIn("0 once more", said)
        [finding] = self.data()["findings"]
        self.assertEqual((finding["found"], finding["series"]),
                         ("not the same bits", "catalog height_fog_down"))

    def test_a_planted_change_is_found_and_named(self):
        self.kill_the_second_run()
        self.accept()
        done = self.neph(*FOG, "-s", "march:steps=56", code=1, **LONELY)
        worst = self.data()["findings"][0]
        self.assertEqual((worst["found"], worst["step"]), ("worse", "catalog height_fog_down"))
        self.assertIn("/march/", worst["series"])
        self.assertIn("neph validate height_fog_down", done.stdout)
        self.assertIn("-s march:steps=56", done.stdout)
        suite = xml.etree.ElementTree.parse(self.folder / "nightly/junit.xml").getroot()
        failed = [case.get("name") for case in suite if case.find("failure") is not None]
        self.assertIn(worst["series"], failed)
        self.assert_the_page_shows(worst["series"])

    def test_limits_of_repeated_runs(self):
        self.neph(*FOG, code=1, **LONELY)
        report = self.data()
        errors = [row["series"] for row in report["series"] if "contrast" not in row["series"]]
        names = []
        for run, factor in enumerate((1, 1.02, 0.97, 1.05, 0.99, 1.01)):
            for row in report["series"]:
                if "/tracer/" in row["series"]:
                    row["tonight"] *= factor
            names.append(self.put(f"{run}/nightly.json", json.dumps(report)))
        self.neph("limits", *names[:4], code=64, said="4 nightly runs are named, at least 5")
        self.neph("limits", *names, names[0], code=65, said="have the same numbers, others differ")
        limits = self.json("limits", *names)
        self.assertEqual(limits["runs"], 6)
        self.assertEqual([row["series"] for row in limits["limits"] if row["limit"] is not None],
                         errors)
        path = self.folder / "limits.json"
        self.neph(*FOG, "--limits", path, **LONELY)  # without a baseline
        self.assertEqual((self.data()["compared"], self.data()["findings"]), (len(errors), []))
        low = next(row for row in limits["limits"] if row["series"].endswith("rel_rmse/exact") and
                   row["confidence"])
        low["limit"] = low["lowest"] / 2
        path.write_text(json.dumps(limits))
        self.neph(*FOG, "--limits", path, code=1, **LONELY)
        found = self.data()["findings"]
        self.assertEqual([(row["found"], row["series"]) for row in found],
                         [("worse", low["series"])])
        self.assertIn("is beyond the limit", found[0]["words"])
        self.neph(*FOG, "--limits", names[0], code=65, said="is not a file of limits of nightly")

    def assert_the_page_shows(self, series):
        """With both frames, its history and the command; e2e_night_page.py checks it in detail."""
        page = self.folder / "nightly/report"
        data = json.loads((page / "data.json").read_text())
        shown = data["findings"][0]
        self.assertEqual((data["state"], shown["series"]), ("finished", series))
        self.assertIn("-s march:steps=56", shown["command"])
        self.assertEqual([point["night"] for point in shown["trend"]], [1, 2])
        self.assertGreater(shown["shown"]["difference"]["changed"], 0.5)
        names = [shown["shown"][side]["picture"] for side in ("accepted", "tonight", "difference")]
        self.assertEqual(len(set(names)), 3)
        for name in names:
            self.assertTrue((page / name).read_bytes().startswith(b"\x89PNG"), name)

    @night.of_the_night
    def test_other_seeds_are_no_alarm_and_a_fresh_store_gives_the_same(self):
        slab = ["nightly", "--only", "catalog height_fog_down", "--only",
                "catalog scattering_slab_above", "--size", "32x18", "-q", "--once"]
        self.neph(*slab, code=1, **LONELY)
        first = self.values()
        self.setUp()
        self.neph(*slab, code=1, **LONELY)
        self.assertEqual(self.values(), first)  # tracers, too: equal seeds
        self.accept()
        for seed in (2, 3, 4):
            self.neph(*slab, "--seed", seed, **LONELY)
            self.assertEqual(self.data()["findings"], [])
            self.assertEqual(self.data()["compared"], len(first) - self.count("contrast"))
            other = {name for name, value in self.values().items() if value != first[name]}
            self.assertTrue(other)
            self.assertEqual({name.split("/")[2] for name in other}, {"tracer"})

    def values(self):
        return {row["series"]: row["tonight"] for row in self.data()["series"]}

    def count(self, metric):
        return sum(name.split("/")[3] == metric for name in self.values())

    @night.of_the_night
    def test_a_change_that_was_meant_is_accepted(self):
        self.neph(*FOG, code=1, **LONELY)
        self.accept()
        self.neph(*FOG, "-s", "march:steps=56", code=1, **LONELY)
        series = self.data()["findings"][0]["series"]
        self.accept(series)
        self.neph(*FOG, "-s", "march:steps=56", **LONELY, code=1)  # other series are still worse
        self.assertNotIn(series, [row["series"] for row in self.data()["findings"]])
        self.accept()
        self.neph(*FOG, "-s", "march:steps=56", **LONELY)

    @night.of_the_night
    def test_kills_at_twenty_moments_end_in_the_same_store(self):
        self.neph(*QUICK, code=1)
        expected = self.numbers_and_keys()
        self.setUp()
        begun = time.monotonic()
        self.neph(*QUICK, code=1)
        takes, seed = time.monotonic() - begun, time.time_ns() % 1000
        self.setUp()
        moments, killed = random.Random(seed), 0
        for _ in range(20):
            child = self.start(*QUICK)
            time.sleep(moments.uniform(0.0, 0.8 * takes))
            killed += child.poll() is None
            child.kill()
            child.wait()
        self.neph(*QUICK, code=1)
        self.assertGreater(killed, 3, f"seed {seed}")  # some runs end before the kill
        [numbers], jobs = expected
        nights, now = self.numbers_and_keys()
        self.assertEqual((nights, now), ([numbers] * len(nights), jobs), f"seed {seed}")
        self.neph("store", "check")

    def numbers_and_keys(self):
        """Values of each finished run, and keys of the store."""
        document = json.loads(self.neph("store", "export").stdout)
        return ([[(m["series"], m["value"]) for m in night["measurements"]]
                 for night in document["nights"]],
                [(job["key"], job["scene"], job["settings"]) for job in document["jobs"]])

    @night.of_the_night
    def test_time_that_is_short_is_spent_on_one_step(self):
        self.neph(*QUICK, "--minutes", "0.01", code=1)
        done = [step["done"] for step in self.data()["steps"]]
        self.assertEqual(sorted(done), [False, True])
        self.neph(*QUICK, "--minutes", "0.01", "--revision", "b", code=1)  # now the other step
        self.assertEqual([step["done"] for step in self.data()["steps"]],
                         [not it for it in done])

    def test_wrong_arguments_are_refused(self):
        for arguments in (["baseline", "accept"], ["baseline", "accept", "--why", " "],
                          ["baseline", "forget"], ["nightly", "--tier", "slow"],
                          ["nightly", "--only", "nothing"], ["store"], ["store", "mend"],
                          ["store", "gc"]):
            self.neph(*arguments, code=64)
        self.neph("baseline", "accept", "--why", "x", code=66)
        self.neph("store", "check", code=66)
        self.neph("store", "gc", "--limit", "much", code=66)


if __name__ == "__main__":
    unittest.main()
