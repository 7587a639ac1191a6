#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph serve`: the page of a nightly run, acceptance by a browser, and who is refused.

The run is a document in the store and a made-up page (e2e_night_page.py)."""
import concurrent.futures
import http.client
import json
import os
import pathlib
import random
import signal
import socket
import unittest
import urllib.parse

import e2e_night_page
import night
import neph_case
from pages import PAGE, node, skip_without_a_browser

NIGHT = 7
FOG = "catalog/fog@15da7c6d/march/radiance rel_rmse/exact"
BIAS = "catalog/fog@15da7c6d/march/radiance rel_bias/exact"


def document(number):
    """A finished run, as it is in the store."""
    return {"format": "neph-night-1", "night": number, "started_utc": "2026-11-25T02:00:00Z",
            "ended_utc": "2026-11-25T02:10:00Z", "plan": "p", "revision": "r", "program": "0123",
            "host": "EPYC x 2", "verdict": "fail", "frames": [],
            "steps": [{"name": "catalog fog", "outcome": "done", "reason": "", "size": "96x54",
                       "wall_s": 1.0, "calibration_s": None}],
            "measurements": [{"series": series, "step": "catalog fog", "kind": "fixed",
                              "value": 0.04, "standard_error": None, "environment": "V",
                              "judgement": "worse", "frame": ""} for series in (FOG, BIAS)]}


@unittest.skipIf(os.environ.get("NEPH_HAS_SERVER") == "0", "neph was built without libmicrohttpd")
class Serve(neph_case.NephCase):
    def setUp(self):
        super().setUp()
        (self.folder / "store").mkdir()
        self.neph("store", "check", "-o", self.folder)
        self.add_night(NIGHT)
        e2e_night_page.build(self.folder / "nightly/report")
        (self.folder / "nightly/logs").mkdir()
        (self.folder / "nightly/logs/fog.log").write_text("a log\n")
        (self.folder / "secret.txt").write_text("a secret\n")
        self.server = self.start("serve", "-o", self.folder, "--json")
        self.addCleanup(self.stop)
        self.url = json.loads(self.server.stdout.readline())["url"]
        parts = urllib.parse.urlsplit(self.url)
        self.host, self.token = parts.netloc, parts.path.split("/")[1]
        self.assertEqual(parts.path, f"/{self.token}/report/")
        self.assertRegex(self.token, "^[0-9a-f]{64}$")

    def stop(self):
        if self.server.poll() is None:
            self.server.kill()
        self.server.communicate()

    def add_night(self, number):
        path = self.folder / f"store/history/night-{number:06}.json"
        path.parent.mkdir(exist_ok=True)
        path.write_text(json.dumps(document(number)))

    def ask(self, path, method="GET", body=None, token=None, connection=None, **headers):
        """Returns the code and the body of the answer."""
        to = connection or http.client.HTTPConnection(self.host, timeout=60)
        token = self.token if token is None else token
        to.request(method, f"/{token}/{path}", body,
                   {name.replace("_", "-"): value for name, value in headers.items()})
        answer = to.getresponse()
        text = answer.read()
        if not connection:
            to.close()
        return answer.status, text

    def state(self):
        code, text = self.ask("approval")
        self.assertEqual(code, 200, text)
        return json.loads(text)

    def post(self, request, **headers):
        body = request if isinstance(request, (bytes, str)) else json.dumps(request)
        return self.ask("approval", "POST", body, **{"Origin": f"http://{self.host}", **headers})

    def request(self, **changed):
        return {"nonce": self.state()["nonce"], "night": NIGHT, "series": [FOG],
                "why": "looked at", **changed}

    def accepted(self):
        return [(one["series"], one["night"], one["why"])
                for one in self.json("baseline", "list", "-o", self.folder)]

    def check_is_up(self):
        self.assertEqual(self.ask("report/")[0], 200)
        self.assertIsNone(self.server.poll())

    # ---- the page ------------------------------------------------------------------------------

    def test_files_of_the_run_are_served(self):
        for path, wanted in (("report/", "report/index.html"), ("report/index.html",) * 2,
                             ("report/data.json",) * 2, ("report/images/a.png",) * 2,
                             ("logs/fog.log",) * 2):
            self.assertEqual(self.ask(path), (200, (self.folder / "nightly" / wanted).read_bytes()))
        self.assertEqual(self.ask("")[0], 302)
        self.assertEqual(self.ask("report/", "HEAD"), (200, b""))

    def test_no_path_leads_outside(self):
        (self.folder / "nightly/report/link.txt").symlink_to(self.folder / "secret.txt")
        (self.folder / "nightly/report/up").symlink_to(self.folder)
        (self.folder / "nightly/.hidden").write_text("a secret\n")
        os.mkfifo(self.folder / "nightly/report/pipe")
        for path in ("../secret.txt", "%2e%2e/secret.txt", "report/../../secret.txt",
                     "report/..%2f..%2fsecret.txt", f"/{self.folder}/secret.txt",
                     f"{self.folder}/secret.txt", "%2fetc/passwd", "report/link.txt",
                     "report/up/secret.txt", ".hidden", "report/pipe", "report", "logs/",
                     "report//index.html", "report/index.html/", "report/./index.html",
                     "report/..", "..%00", "a" * 5000, "store/history/night-000007.json"):
            with self.subTest(path):
                code, text = self.ask(path)
                self.assertIn(code, (404, 414))
                self.assertNotIn(b"secret", text)
        self.check_is_up()

    # ---- who may ask ---------------------------------------------------------------------------

    def test_who_has_no_token_is_refused(self):
        wrong = ["", "x", "0" * 64, self.token[:-1], self.token + "0", self.token.upper() + "x",
                 self.token[:-1] + ("0" if self.token[-1] != "0" else "1")]
        for token in wrong:
            for path in ("report/", "approval", "../" + self.token + "/report/"):
                code, text = self.ask(path, token=token)
                self.assertEqual(code, 403)
                self.assertNotIn(self.token.encode(), text)
        self.assertEqual(self.post(self.request(), Host="x")[0], 403)
        self.assertEqual(self.ask("approval", "POST", "{}", token="0" * 64)[0], 403)
        self.assertEqual(self.accepted(), [])

    def test_another_origin_is_refused(self):
        port = self.host.split(":")[1]
        good = self.request()
        for headers in ({"Origin": "http://evil.example"}, {"Origin": "null"}, {"Origin": ""},
                        {"Origin": f"https://{self.host}"}, {"Origin": "http://127.0.0.1"},
                        {"Origin": f"http://localhost:{port}"},
                        {"Sec_Fetch_Site": "cross-site"}, {"Sec_Fetch_Site": "same-site"},
                        {"Host": f"evil.example:{port}"}, {"Host": "127.0.0.1"}):
            with self.subTest(headers):
                self.assertEqual(self.post(good, **headers)[0], 403)
                self.assertEqual(self.ask("report/", **headers)[0], 403)
        self.assertEqual(self.ask("approval", "POST", json.dumps(good))[0], 403)  # from no page
        for method in ("PUT", "DELETE", "OPTIONS", "PATCH"):
            self.assertEqual(self.ask("approval", method, Origin=f"http://{self.host}")[0], 405)
        self.assertEqual(self.ask("report/", "POST", "{}", Origin=f"http://{self.host}")[0], 405)
        self.assertEqual(self.accepted(), [])
        local = f"localhost:{port}"  # another name of this server
        self.assertEqual(self.post(good, Host=local, Origin=f"http://{local}")[0], 200)

    # ---- acceptance ----------------------------------------------------------------------------

    def test_an_acceptance_is_taken_once(self):
        good = self.request(series=[FOG, BIAS])
        code, text = self.post(good)
        self.assertEqual(code, 200, text)
        state = json.loads(text)
        self.assertEqual([one["series"] for one in state["acceptances"]], [FOG, BIAS])
        self.assertNotEqual(state["nonce"], good["nonce"])
        wanted = [(FOG, NIGHT, "looked at"), (BIAS, NIGHT, "looked at")]
        self.assertEqual(self.accepted(), wanted)
        for _ in range(2):
            self.assertEqual(self.post(good)[0], 409)  # the same request again
        self.assertEqual(self.accepted(), wanted)
        self.assertEqual(self.post(self.request(series=["*"], why="all"))[0], 200)
        self.assertEqual(self.accepted(), [*wanted, ("*", NIGHT, "all")])
        told = [json.loads(self.server.stdout.readline()) for _ in range(2)]
        self.assertEqual([one["accepted"] for one in told], [[FOG, BIAS], ["*"]])

    def test_the_command_accepts_several_series_or_all(self):
        both = self.neph("baseline", "accept", FOG, BIAS, "--why", "both", "-o", self.folder)
        self.assertEqual(both.stdout.splitlines(), [
            f"nightly run {NIGHT} is the baseline of {series}" for series in (FOG, BIAS)])
        for words in ([], ["*"]):
            done = self.neph("baseline", "accept", *words, "--why", "all", "-o", self.folder)
            self.assertEqual(done.stdout, f"nightly run {NIGHT} is the baseline of all series\n")
        before = self.accepted()
        self.neph("baseline", "accept", FOG, "catalog/no", "--why", "x", "-o", self.folder,
                  code=66, silent=True)
        self.assertEqual(self.accepted(), before)

    def test_wrong_requests_accept_nothing(self):
        for code, request in (
                (400, "{"), (400, "[]"), (400, b"\xff\xfe"), (400, ""), (400, "null"),
                (400, '{"nonce": "", "nonce": ""}'), (400, "[" * 5000),
                (400, self.request(series=[])), (400, self.request(series=FOG)),
                (400, self.request(series=[1])), (400, self.request(series=[FOG] * 1025)),
                (400, self.request(why=" \n")), (400, self.request(why="x" * 1001)),
                (400, self.request(why="a\u0007b")), (400, self.request(night="7")),
                (400, self.request(more=1)), (413, "x" * 70000),
                (409, self.request(nonce="0" * 32)), (409, self.request(night=6)),
                (409, self.request(night=8)), (404, self.request(series=[FOG, "catalog/no"]))):
            with self.subTest(str(request)[:80]):
                got, text = self.post(request)
                self.assertEqual(got, code, text)
                if code != 413:
                    self.assertTrue(json.loads(text)["error"])
        self.assertEqual(self.accepted(), [])

    def test_a_page_of_an_earlier_run_accepts_nothing(self):
        good = self.request()
        self.add_night(NIGHT + 1)
        self.assertEqual(self.post(good)[0], 409)
        self.assertEqual(self.state()["night"], NIGHT + 1)
        self.assertEqual(self.accepted(), [])

    # ---- endurance -----------------------------------------------------------------------------

    def hammer(self, seed, count):
        """Sends requests with guessed tokens, requests of other origins and replays."""
        draw = random.Random(seed)
        connection = http.client.HTTPConnection(self.host, timeout=60)
        codes = set()
        for _ in range(count):
            guess = f"{draw.getrandbits(256):064x}"
            kind = draw.randrange(4)
            codes.add(self.ask("report/", connection=connection)[0] if kind == 0 else
                      self.ask("approval", token=guess, connection=connection)[0] if kind == 1 else
                      self.ask("approval", "POST", "{}", connection=connection,
                               Origin="http://evil.example")[0] if kind == 2 else
                      self.ask("approval", "POST", connection=connection,
                               body=json.dumps({"nonce": guess[:32], "night": NIGHT,
                                                "series": ["*"], "why": "x"}),
                               Origin=f"http://{self.host}")[0])
        connection.close()
        return codes

    def test_many_requests(self):
        count = 10000 if os.environ.get("NEPH_TEST_NIGHT") else 1000
        seed = random.randrange(1 << 32)
        print(f"seed {seed}")
        with concurrent.futures.ThreadPoolExecutor(8) as threads:
            found = threads.map(lambda n: self.hammer(seed + n, count // 8), range(8))
            codes = set().union(*found)
        self.assertEqual(codes, {200, 403, 409})
        self.assertEqual(self.accepted(), [])
        self.check_is_up()

    def test_broken_clients(self):
        port = int(self.host.split(":")[1])
        head = f"POST /{self.token}/approval HTTP/1.1\r\nHost: {self.host}\r\n" \
               f"Origin: http://{self.host}\r\n"
        for text in ("", "\r\n\r\n", "GET", "\0" * 1000, "GET / HTTP/9.9\r\n\r\n", "x" * 100000,
                     "GET / HTTP/1.1\r\n" + "A: b\r\n" * 20000,
                     head + "Content-Length: 100\r\n\r\n{", head + "Content-Length: -1\r\n\r\n{}",
                     head + "Content-Length: 99999999999999999999\r\n\r\n{}",
                     head + "Transfer-Encoding: chunked\r\n\r\n" + ("8000\r\n" + "x" * 0x8000 +
                                                                    "\r\n") * 8):
            with socket.create_connection(("127.0.0.1", port), timeout=60) as client:
                try:
                    client.sendall(text.encode())
                except OSError:
                    pass  # it was refused before its end
        self.check_is_up()
        self.assertEqual(self.accepted(), [])

    @night.of_the_night
    def test_silent_clients_are_dropped(self):
        """More of them than the server has room for; they are dropped after 10 s."""
        port = int(self.host.split(":")[1])
        silent = [socket.create_connection(("127.0.0.1", port)) for _ in range(100)]
        self.check_is_up()
        for client in silent:
            client.close()

    # ---- the program ---------------------------------------------------------------------------

    def test_it_listens_on_the_loopback_address_alone(self):
        port = int(self.host.split(":")[1])
        rows = [row.split() for row in pathlib.Path("/proc/net/tcp").read_text().splitlines()[1:]]
        heard = {row[1] for row in rows
                 if row[3] == "0A" and int(row[1].split(":")[1], 16) == port}
        self.assertEqual(heard, {f"0100007F:{port:04X}"})

    def test_ctrl_c_ends_it(self):
        self.check_is_up()
        self.server.send_signal(signal.SIGINT)
        out, err = self.server.communicate(timeout=60)
        self.assertEqual((self.server.returncode, out), (0, ""))
        self.assertIn("1 requests answered, 0 refused", err)
        self.assertNotIn(self.token, err)

    def test_wrong_use(self):
        self.neph("serve", "-o", self.folder / "none", code=66, said="neph nightly", silent=True)
        self.neph("serve", "-o", self.folder, "--port", self.host.split(":")[1], code=74,
                  said="cannot listen", silent=True)
        self.neph("serve", "-o", self.folder, "--port", 80, code=64, said="1024", silent=True)

    def test_by_keyboard_in_a_browser(self):
        skip_without_a_browser("acceptance by the keyboard")
        series = "\n".join((FOG, BIAS))
        done = node(PAGE / "check_serve.mjs", self.url, series, "the new steps are right")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(self.accepted(), [(FOG, NIGHT, "the new steps are right"),
                                           (BIAS, NIGHT, "the new steps are right")])


@unittest.skipIf(os.environ.get("NEPH_HAS_SERVER") != "0", "neph was built with libmicrohttpd")
class Missing(neph_case.NephCase):
    def test_it_says_what_is_missing(self):
        (self.folder / "store").mkdir()
        (self.folder / "nightly").mkdir()
        self.neph("serve", "-o", self.folder, code=69, said="libmicrohttpd-dev", silent=True)


if __name__ == "__main__":
    unittest.main(verbosity=2)
