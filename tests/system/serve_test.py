#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The web console's server: the same answers as the commands, nobody who should not, and no way to crash it.

Usage: serve_test.py BIN_DIR DOCS_DIR [unittest arguments], inside a network namespace of its own.
"""
import base64
import gzip
import hashlib
import http.client
import io
import json
import os
import random
import resource
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.parse
import zipfile

import jsonschema

BIN, DOCS = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
CONSOLE = os.path.join(BIN, "operator_console")
TILE, LOWER = 16 + 1024 * 14, 16


def schema(name):
    with open(os.path.join(DOCS, "schemas", name + ".schema.json"), encoding="utf-8") as file:
        return json.load(file)


def command(*arguments):
    done = subprocess.run([CONSOLE, "--log-level", "error", *arguments], capture_output=True, text=True, timeout=120)
    if done.returncode != 0:
        raise AssertionError(f"{arguments}: exit {done.returncode}\n{done.stderr}")
    return done.stdout


class Server:
    """operator_console serve, ended at the end."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen([CONSOLE, "serve", "--port", "0", "--json", *arguments], stdout=subprocess.PIPE)
        said = json.loads(self.process.stdout.readline())
        self.port, self.token, self.url, self.foxglove = said["port"], said["token"], said["url"], said.get("foxglove")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(timeout=20)
        self.process.stdout.close()
        assert code == 0, f"serve ended with {code}"

    def ask(self, path, method="GET", body=None, headers=None, host=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        connection.putheader("Host", host or f"127.0.0.1:{self.port}")
        for name, value in (headers or {}).items():
            connection.putheader(name, value)
        body = body.encode() if isinstance(body, str) else body
        if body is not None:
            connection.putheader("Content-Length", str(len(body)))
        connection.endheaders(body)
        response = connection.getresponse()
        content = response.read()
        connection.close()
        return response, content

    def json(self, path, status=200):
        response, content = self.ask(path)
        assert response.status == status, (path, response.status, content[:300])
        return json.loads(content)

    def settled(self, phase="whole"):
        for _ in range(600):
            mission = self.json("/api/mission")
            if mission["phase"] == phase:
                return mission
            time.sleep(0.1)
        raise AssertionError(f"it stays {mission}")


def tiles(content):
    """What /api/map says as {(x, y): (label, robot)} from above, and the header."""
    magic, count, cell_size, base, sequence, since, life = struct.unpack_from("<4sIddQQQ", content)
    assert magic == b"SHT2", magic
    cells, at, num_lower, surprises = {}, 48, 0, {}
    for _ in range(count):
        x, y, lower, zero = struct.unpack_from("<iiII", content, at)
        assert zero == 0
        label = struct.unpack_from("<1024i", content, at + 16)
        robot = struct.unpack_from("<1024h", content, at + 16 + 8192)
        surprise = content[at + 16 + 13 * 1024:at + 16 + 14 * 1024]
        for i in range(1024):
            if label[i] >= 0:
                cells[32 * x + i % 32, 32 * y + i // 32] = label[i], robot[i]
                if surprise[i] > 0:
                    surprises[32 * x + i % 32, 32 * y + i // 32] = surprise[i] / 8
        at += TILE + lower * LOWER
        num_lower += lower
    assert at == len(content), (at, len(content))
    return cells, {"cell_size": cell_size, "sequence": sequence, "since": since, "life": life, "count": count, "lower": num_lower, "surprises": surprises}


class WebSocket:
    """A client as Foxglove is one, written from RFC 6455 and the protocol's own page."""

    def __init__(self, url, subprotocol="foxglove.websocket.v1", origin=None, host=None):
        address = url.removeprefix("ws://")
        self.socket = socket.create_connection((address.split(":")[0], int(address.split(":")[1])), timeout=30)
        key = base64.b64encode(os.urandom(16)).decode()
        lines = ["GET / HTTP/1.1", f"Host: {host or address}", "Upgrade: websocket", "Connection: Upgrade", f"Sec-WebSocket-Key: {key}",
                 "Sec-WebSocket-Version: 13"]
        if subprotocol:
            lines.append(f"Sec-WebSocket-Protocol: {subprotocol}")
        if origin:
            lines.append(f"Origin: {origin}")
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.file = self.socket.makefile("rb")
        self.status = int(self.file.readline().split()[1])
        self.headers = {}
        while (line := self.file.readline().strip()):
            name, value = line.decode().split(": ", 1)
            self.headers[name.lower()] = value
        if self.status == 101:
            digest = hashlib.sha1((key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest()
            assert self.headers["sec-websocket-accept"] == base64.b64encode(digest).decode()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()
        self.socket.close()

    def send(self, content, opcode=1, masked=True):
        content = content.encode() if isinstance(content, str) else content
        size = len(content)
        mask = os.urandom(4) if masked else b""
        head = bytes([0x80 | opcode])
        flag = 0x80 if masked else 0
        head += bytes([flag | size]) if size < 126 else bytes([flag | 126]) + struct.pack(">H", size) if size < 65536 else \
            bytes([flag | 127]) + struct.pack(">Q", size)
        self.socket.sendall(head + mask + (bytes(c ^ mask[i % 4] for i, c in enumerate(content)) if masked else content))

    def receive(self):
        """The next message: (opcode, content); None when the server has hung up."""
        opcode, content = None, b""
        while True:
            try:
                head = self.file.read(2)
            except ConnectionError:
                return None
            if len(head) < 2:
                return None
            size = head[1] & 127
            if size == 126:
                size, = struct.unpack(">H", self.file.read(2))
            elif size == 127:
                size, = struct.unpack(">Q", self.file.read(8))
            part = self.file.read(size)
            if head[0] & 15 == 8:
                return None
            if head[0] & 15 == 9:
                self.send(part, 10)
                continue
            opcode = opcode or head[0] & 15
            content += part
            if head[0] & 128:
                return opcode, content

    def said(self):
        opcode, content = self.receive()
        assert opcode == 1, opcode
        return json.loads(content)

    def data(self):
        """A message of a subscription: (its number, nanoseconds, the message)."""
        opcode, content = self.receive()
        assert opcode == 2 and content[0] == 1, (opcode, content[:20])
        return (*struct.unpack_from("<IQ", content, 1), json.loads(content[13:]))


class Serve(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.top = tempfile.mkdtemp(prefix="shoal_serve_")
        cls.run_dir = os.path.join(cls.top, "run")
        command("launch", "--world", "reef:tuning", "--robots", "3", "--observations", "6", "--seed", "7", "--record",
                "--out", cls.run_dir)
        cls.server = Server("--run", cls.run_dir, "--foxglove", "0", "--foxglove-origin", "https://app.example").__enter__()
        cls.server.settled()

    @classmethod
    def tearDownClass(cls):
        cls.server.__exit__()
        shutil.rmtree(cls.top)

    def test_page_and_terminal_give_the_same_answers(self):
        label = json.loads(command("labels", "--run", self.run_dir, "--json"))["labels"][0]["label"]
        with open(os.path.join(self.run_dir, "global_map.csv"), encoding="utf-8") as file:
            x, y = file.readlines()[1].split(",")[:2]
        for path, arguments, name in [("status", ["status"], "status"), ("labels", ["labels"], "labels"), ("edits", ["edits"], "edits"),
                                      (f"at?x={x}&y={y}", ["at", x, y], "at"), (f"why?label={label}", ["why", str(label)], "why"),
                                      (f"area?label={label}&min_m2=2", ["area", str(label), "--min-m2", "2"], "area"),
                                      ("node?node=R01", ["node", "R01"], "node"),
                                      ("surprises?least=2", ["surprises", "--least", "2"], "surprises"), ("diff?from=2&until=5", ["diff", "2", "5"], "diff")]:
            answer = self.server.json("/api/" + path)
            jsonschema.validate(answer, schema(name))
            told = json.loads(command(*arguments, "--run", self.run_dir, "--json"))
            if name == "status":  # a recording's last moment: same map; who has heard whom whole is not in it
                answer, told = ({k: a[k] for k in ("cells", "labels", "mission_id")} for a in (answer, told))
            if name == "node":  # the terminal adds who has fallen silent
                self.assertFalse(told["node"].pop("silent"))
                self.assertGreaterEqual(told["node"].pop("ago_s"), 0)
            self.assertEqual(answer, told, path)

    def test_the_map_is_that_of_the_file(self):
        cells, header = tiles(self.server.ask("/api/map")[1])
        size = header["cell_size"]
        expected = {}
        with open(os.path.join(self.run_dir, "global_map.csv"), encoding="utf-8") as file:
            for row in file.readlines()[1:]:
                x, y, z, label, robot = row.split(",")[:5]
                key = round(float(x) / size), round(float(y) / size)
                if key not in expected or float(z) >= expected[key][0]:
                    expected[key] = float(z), int(label), int(robot[1:])
        self.assertGreater(len(cells), 50)
        self.assertEqual(cells, {key: value[1:] for key, value in expected.items()})
        whole = tiles(self.server.ask("/api/map?cells=all")[1])
        self.assertEqual(whole[0], cells)
        with open(os.path.join(self.run_dir, "global_map.csv"), encoding="utf-8") as file:
            self.assertEqual(len(cells) + whole[1]["lower"], len(file.readlines()) - 1)
        top = {key: value[0] for key, value in expected.items()}
        with open(os.path.join(self.run_dir, "surprise.csv"), encoding="utf-8") as file:
            told = {}
            for row in file.readlines()[1:]:
                x, y, z, _, _, _, surprise = row.split(",")
                key = round(float(x) / size), round(float(y) / size)
                if float(z) == top[key]:
                    told[key] = float(surprise)
        self.assertGreater(len(told), 3)
        self.assertEqual(header["surprises"], told)
        nothing = tiles(self.server.ask(f"/api/map?since={header['sequence']}&life={header['life']}")[1])
        self.assertEqual(nothing[1]["count"], 0)
        stranger = tiles(self.server.ask(f"/api/map?since={header['sequence']}&life=1")[1])
        self.assertEqual(stranger[0], cells)
        zipped, content = self.server.ask("/api/map", headers={"Accept-Encoding": "gzip"})
        self.assertEqual(zipped.getheader("Content-Encoding"), "gzip")
        self.assertEqual(tiles(gzip.decompress(content))[0], cells)

    def test_history_grows(self):
        times = self.server.settled()["times_s"]
        self.assertGreater(len(times), 3)
        self.assertEqual(times, sorted(times))
        counts = [len(tiles(self.server.ask(f"/api/map?at={t}")[1])[0]) for t in times]
        self.assertLess(counts[0], counts[-1])
        self.assertEqual(counts, sorted(counts))
        events = self.server.json("/api/events")["events"]
        self.assertEqual(sum(e["kind"] == "landed" for e in events), 3, events)
        traffic = self.server.json("/api/traffic")
        with open(os.path.join(self.run_dir, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        for node in traffic["nodes"]:
            if node["node"].startswith("R"):
                for i, name in enumerate(traffic["classes"]):  # what was sent after the last heartbeat is not in it
                    said = sum(row[1 + i] for row in node["bins"])
                    self.assertLessEqual(said, summary["bytes"][node["node"]].get(name, 0), (node["node"], name))
        self.assertEqual([t["robot"] for t in self.server.json("/api/tracks")["tracks"]], ["R00", "R01", "R02"])

    def test_all_of_the_description_is_answered(self):
        with open(os.path.join(DOCS, "openapi.json"), "rb") as file:
            said = file.read()
        self.assertEqual(self.server.ask("/openapi.json")[1], said)
        description = json.loads(said)
        for path, methods in description["paths"].items():
            if "get" not in methods or path == "/api/stream":
                continue
            needed = {p["name"]: {"format": "csv", "robot": "R00"}.get(p["name"], "1") for p in methods["get"]["parameters"] if p["required"]}
            response, content = self.server.ask(path + "?" + urllib.parse.urlencode(needed))
            self.assertIn(response.status, (200, 400, 404, 503), path)
            kind, = methods["get"]["responses"]["200"]["content"].items()
            inline = kind[1]["schema"]
            if response.status == 200 and kind[0] == "application/json" and "schemas/" not in json.dumps(inline).replace("components/schemas/", ""):
                jsonschema.validate(json.loads(content), {**inline, "components": description["components"]})
            if response.status != 200:
                self.assertIn("error", json.loads(content))
            if needed:
                self.assertEqual(self.server.ask(path)[0].status, 400, path)

    def test_the_map_as_a_node_holds_it(self):
        with open(os.path.join(DOCS, "openapi.json"), encoding="utf-8") as file:
            said = json.load(file)["paths"]["/api/holding"]["get"]["responses"]["200"]["content"]["application/json"]["schema"]
        # A robot that fuses nothing holds its own, whoever saw those cells later.
        alone, header = tiles(self.server.ask("/api/map?node=R01")[1])
        size, own = header["cell_size"], set()
        with open(os.path.join(self.run_dir, "robots", "R01", "map.csv"), encoding="utf-8") as file:
            for row in file.readlines()[1:]:
                x, y = row.split(",")[:2]
                own.add((round(float(x) / size), round(float(y) / size)))
        self.assertEqual(set(alone), own)
        self.assertEqual({robot for _, robot in alone.values()}, {1})
        held = self.server.json("/api/holding?node=R01")
        jsonschema.validate(held, said)
        self.assertEqual((held["fuses"], [s["robot"] for s in held["shares"]]), (False, ["R01"]))
        # The operator's, while it grew: what its roster names adds up to the digest of the map that it had.
        counts, agreed = [], 0
        for t in self.server.settled()["times_s"]:
            held = self.server.json(f"/api/holding?node=OPERATOR&at={t}")
            jsonschema.validate(held, said)
            self.assertLessEqual(held["at_s"], t)
            self.assertIsNot(held["agrees"], False, held)
            agreed += held["agrees"] is True
            counts.append(len(tiles(self.server.ask(f"/api/map?node=OPERATOR&at={t}")[1])[0]))
        self.assertEqual(counts, sorted(counts))
        self.assertGreater(agreed, 1)
        self.assertIs(held["agrees"], True)
        self.assertTrue(all(s["whole"] and s["certain"] for s in held["shares"]), held)
        self.assertEqual(tiles(self.server.ask("/api/map?node=OPERATOR")[1])[0], tiles(self.server.ask("/api/map")[1])[0])
        for name in ("labels", "status"):
            jsonschema.validate(self.server.json(f"/api/{name}?node=R01"), schema(name))
        self.assertIn("OPERATOR R00 R01", self.server.json("/api/map?node=R07", 404)["error"])

    def test_exports_are_those_of_the_command(self):
        mission = self.server.json("/api/mission")
        self.assertEqual([e["format"] for e in mission["exports"]], mission["formats"])
        for export in mission["exports"]:
            folder = os.path.join(self.top, "export_" + export["format"])
            os.mkdir(folder)
            origin = ("--origin", "43.5", "-70.25", "--heading", "12") if export["origin"] != "no" else ()
            command("export", "--format", export["format"], "--out", os.path.join(folder, export["file"]), "--run", self.run_dir, *origin)
            expected = {}
            for name in os.listdir(folder):
                with open(os.path.join(folder, name), "rb") as file:
                    expected[name] = file.read()
            self.assertEqual(set(expected), {export["file"], *export["beside"]})
            path = "/api/export?format=" + export["format"] + ("&latitude=43.5&longitude=-70.25&heading=12" if origin else "")
            self.assertEqual(self.server.ask(path)[1], expected[export["file"]], export)
            with zipfile.ZipFile(io.BytesIO(self.server.ask(path + "&packed=zip")[1])) as archive:
                self.assertIsNone(archive.testzip())
                self.assertEqual({name: archive.read(name) for name in archive.namelist()}, expected, export)
        self.assertIn("over", self.server.json("/api/ask?label=1", 404)["error"])  # nobody is there to be asked
        for wrong in ("format=kml", "format=ply&latitude=1&longitude=2", "format=geotiff&latitude=1", "format=geotiff&heading=3",
                      "format=geotiff&latitude=99&longitude=0", "format=geotiff&packed=tar", "format=shp"):
            self.assertEqual(self.server.ask("/api/export?" + wrong)[0].status, 400, wrong)

    def test_pictures_are_those_of_the_run(self):
        with open(os.path.join(self.run_dir, "pictures", "pictures.json"), encoding="utf-8") as file:
            index = json.load(file)
        held = {row["label"]: row["pictures"] for row in self.server.json("/api/pictures")["labels"]}
        self.assertGreater(len(index["labels"]), 1)
        for row in index["labels"]:
            for kept in row["pictures"]:
                said = [p for p in held[row["label"]] if (p["robot"], p["topic"], p["example"]) == (kept["robot"], kept["topic"], kept["example"])]
                self.assertEqual([p["seen_s"] for p in said], [kept["seen_s"]])
                with open(os.path.join(self.run_dir, "pictures", kept["file"]), "rb") as file:
                    path = f"/api/picture?robot={kept['robot']}&topic={kept['topic']}&example={kept['example']}"
                    self.assertEqual(self.server.ask(path)[1], file.read(), kept)
        self.assertEqual(self.server.json("/api/pictures?at=0")["labels"], [])
        for wrong, status in (("robot=R00&topic=0&example=99", 404), ("robot=&topic=0&example=0", 400), ("robot=R00&topic=x&example=0", 400)):
            self.assertEqual(self.server.ask("/api/picture?" + wrong)[0].status, status, wrong)

    def test_the_truth_is_what_scores_the_map(self):
        for _ in range(300):
            response, content = self.server.ask("/api/classes")
            if response.status != 503:
                break
            time.sleep(0.1)
        classes = {c["id"] for c in json.loads(content)["classes"]}
        labels, header = tiles(self.server.ask("/api/map")[1])
        truth, same = tiles(self.server.ask("/api/truth")[1])
        self.assertEqual(same["sequence"], header["sequence"])
        self.assertLessEqual({c for c, _ in truth.values()}, classes)
        scored = json.loads(command("score", "--world", "reef:tuning", "--run", self.run_dir, "--json"))
        self.assertEqual((scored["scored"], len({c for c, _ in truth.values()})), (scored["cells"], scored["classes"]))
        self.assertEqual(set(truth), set(labels))
        with Server("--log", os.path.join(self.run_dir, "mission.lcmlog")) as other:
            self.assertFalse(other.settled()["truth"])
            self.assertEqual(other.ask("/api/classes")[0].status, 404)

    def test_foxglove_looks_at_the_same_mission(self):
        cells, header = tiles(self.server.ask("/api/map?cells=all")[1])
        colors = {row["label"]: bytes.fromhex(row["color"][1:]) for row in self.server.json("/api/labels")["labels"]}
        for offered, spoken in (("foxglove.sdk.v1", "foxglove.sdk.v1"), ("foxglove.sdk.v1, foxglove.websocket.v1", "foxglove.websocket.v1")):
            with WebSocket(self.server.foxglove, subprotocol=offered) as client:
                self.assertEqual((client.status, client.headers["sec-websocket-protocol"]), (101, spoken))
        with WebSocket(self.server.foxglove) as client:
            self.assertEqual((client.status, client.headers["sec-websocket-protocol"]), (101, "foxglove.websocket.v1"))
            info, offer = client.said(), client.said()
            self.assertEqual((info["op"], info["name"], offer["op"]), ("serverInfo", "Shoal", "advertise"))
            channels = {c["topic"]: c for c in offer["channels"]}
            self.assertEqual(list(channels), ["/map", "/tf", "/events", "/labels", "/status"])
            self.assertEqual({c["encoding"] + c["schemaEncoding"] for c in channels.values()}, {"jsonjsonschema"})

            def subscribe(number, topic):
                client.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": number, "channelId": channels[topic]["id"]}]}))

            subscribe(70, "/map")
            number, _, cloud = client.data()
            self.assertEqual(number, 70)
            jsonschema.validate(cloud, json.loads(channels["/map"]["schema"]))
            points, stride = base64.b64decode(cloud["data"]), cloud["point_stride"]
            self.assertEqual(len(points), (len(cells) + header["lower"]) * stride)
            at = {f["name"]: f["offset"] for f in cloud["fields"]}
            top = {}
            for i in range(0, len(points), stride):
                x, y, z = struct.unpack_from("<fff", points, i)
                label, = struct.unpack_from("<i", points, i + at["label"])
                robot, = struct.unpack_from("<H", points, i + at["robot"])
                self.assertEqual(points[i + at["red"]:i + at["red"] + 3], colors[label])
                key = round(x / header["cell_size"]), round(y / header["cell_size"])
                if key not in top or z >= top[key][0]:
                    top[key] = z, (label, robot)
            self.assertEqual({key: value[1] for key, value in top.items()}, cells)
            subscribe(71, "/status")
            self.assertEqual(client.data()[2], self.server.json("/api/status"))
            subscribe(72, "/tf")
            seen = [client.data() for _ in range(3)]
            self.assertEqual({s[2]["child_frame_id"] for s in seen}, {"R00", "R01", "R02"})
            jsonschema.validate(seen[0][2], json.loads(channels["/tf"]["schema"]))
            client.send(json.dumps({"op": "unsubscribe", "subscriptionIds": [70, 71, 72]}))
            subscribe(73, "/events")
            events = self.server.json("/api/events")["events"]
            told = [client.data() for _ in events]
            self.assertEqual([t[2]["message"] for t in told], [e["text"] for e in events])
            for nonsense in ("{", "[]", "7", '{"op": 3}', '{"op": "subscribe"}', '{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 9}]}',
                             '{"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 1e99}]}'):
                client.send(nonsense)
                said = client.said()
                self.assertEqual((said["op"], said["level"]), ("status", 2), said)
            client.send(b"\1\2\3", opcode=2)
            client.send('{"op": "of a later version"}')
            subscribe(74, "/labels")
            self.assertEqual([row["label"] for row in client.data()[2]["labels"]], sorted(colors))

    def test_strangers_do_not_look_through_foxglove(self):
        for options, status in (({"origin": "https://other.example"}, 403), ({"host": "evil.example"}, 403), ({"subprotocol": None}, 426),
                                ({"subprotocol": "chat"}, 426), ({"origin": "https://app.example"}, 101)):
            with WebSocket(self.server.foxglove, **options) as client:
                self.assertEqual(client.status, status, options)
        for bad in (lambda c: c.send("{}", masked=False), lambda c: c.send("x" * 70000), lambda c: c.socket.sendall(b"\xff" * 64)):
            with WebSocket(self.server.foxglove) as client:
                client.said(), client.said()
                bad(client)
                self.assertIsNone(client.receive())
        address = self.server.foxglove.removeprefix("ws://").split(":")
        silent = [socket.create_connection((address[0], int(address[1]))) for _ in range(40)]  # more than there is room for
        silent[0].sendall(b"GET / HTTP/1.1\r\nHo")
        silent[1].sendall(b"\0" * 20000)
        for s in silent:
            s.close()
        for _ in range(50):
            try:
                with WebSocket(self.server.foxglove) as client:
                    self.assertEqual(client.said()["op"], "serverInfo")
                    break
            except (OSError, IndexError):
                time.sleep(0.1)
        else:
            self.fail("it does not come back")
        self.assertEqual(self.server.ask("/api/status")[0].status, 200)

    def test_what_the_library_names_says_so(self):
        with tempfile.TemporaryDirectory(prefix="shoal_library_") as top:
            first, second, file = (os.path.join(top, name) for name in ("first", "second", "reef.library"))
            shutil.copytree(self.run_dir, first)
            rows = json.loads(command("labels", "--run", first, "--json"))["labels"]
            command("name", str(max(rows, key=lambda row: row["cells"])["label"]), "sand", "--run", first)
            command("library", "save", "--run", first, "--out", file)
            command("launch", "--world", "reef:tuning", "--robots", "2", "--observations", "6", "--seed", "7", "--library", file, "--record",
                    "--out", second)
            for recorded in (True, False):
                if not recorded:
                    os.remove(os.path.join(second, "mission.lcmlog"))
                with Server("--run", second) as server:
                    server.settled()
                    labels = server.json("/api/labels")
                    jsonschema.validate(labels, schema("labels"))
                    self.assertIn(["sand"], [row["library"] for row in labels["labels"]])
                    self.assertIn([], [row["library"] for row in labels["labels"]])
                    self.assertEqual(labels, json.loads(command("labels", "--run", second, "--json")))
                    tracks = {t["robot"]: t["points"] for t in server.json("/api/tracks")["tracks"]}
                    for robot in ("R00", "R01"):
                        with open(os.path.join(second, "robots", robot, "poses.txt"), encoding="utf-8") as file:
                            poses = [[float(v) for v in line.split()[:4]] for line in file if not line.startswith("#")]
                        self.assertEqual([p[1:] for p in tracks[robot]][-1], [round(v, 3) for v in poses[-1][1:]])
                        if not recorded:
                            self.assertEqual(tracks[robot], [[round(v, 3) for v in pose] for pose in poses])

    def test_strangers_are_turned_away(self):
        ask = self.server.ask
        self.assertEqual(ask("/api/status", host="evil.example:80")[0].status, 403)
        self.assertEqual(ask("/api/status", host=f"localhost:{self.server.port}")[0].status, 200)
        self.assertEqual(ask("/api/status", headers={"Origin": "http://evil.example"})[0].status, 403)
        edit = json.dumps({"edit": "exclude", "robot": "R00"})
        self.assertEqual(ask("/api/edit", "POST", edit)[0].status, 401)
        self.assertEqual(ask("/api/edit", "POST", edit, {"Authorization": "Bearer " + "0" * 32})[0].status, 401)
        self.assertEqual(ask("/api/edit", "GET")[0].status, 404)
        self.assertEqual(ask("/api/status", "DELETE")[0].status, 405)
        key = {"Authorization": "Bearer " + self.server.token}
        for wrong in ("", "[]", "{", "7", '{"edit": "burn"}', '{"edit": "name"}'):
            self.assertEqual(ask("/api/edit", "POST", wrong, key)[0].status, 400, wrong)
        self.assertEqual(ask("/api/edit", "POST", "x" * 70000, key)[0].status, 413)
        with Server("--run", self.run_dir, "--read-only") as other:
            self.assertEqual(other.token, "")
            other.settled()
            self.assertEqual(other.ask("/api/edit", "POST", edit, {"Authorization": "Bearer "})[0].status, 403)
        for path in ("/../../etc/passwd", "/%2e%2e/etc/passwd", "//etc/passwd", "/page.js/../x", "/\x01", "/%00", "/" + "a" * 3000):
            response, content = ask(path.replace("\x01", "%01"))
            self.assertIn(response.status, (400, 404, 414), path)
            self.assertNotIn(b"root:", content)

    def test_decisions_reach_the_map_and_are_undone(self):
        folder = os.path.join(self.top, "judged")
        shutil.copytree(self.run_dir, folder)
        with Server("--run", folder) as server:
            server.settled()
            key = {"Authorization": "Bearer " + server.token}
            label = server.json("/api/labels")["labels"][0]["label"]

            def decide(**edit):
                response, content = server.ask("/api/edit", "POST", json.dumps(edit), key)
                self.assertEqual(response.status, 200, content)

            def until(what):
                for _ in range(200):
                    if what():
                        return
                    time.sleep(0.1)
                self.fail("it was decided, and nothing came of it")

            decide(edit="name", label=str(label), text="<b>sand</b>")
            until(lambda: any(l["name"] == "<b>sand</b>" for l in server.json("/api/labels")["labels"]))
            server.settled()
            before = tiles(server.ask("/api/map")[1])
            decide(edit="exclude", robot="R01")
            until(lambda: all(r != 1 for _, r in tiles(server.ask("/api/map")[1])[0].values()))
            decide(edit="undo")
            until(lambda: tiles(server.ask("/api/map")[1])[0] == before[0])

    def test_nothing_that_is_sent_ends_it(self):
        rng = random.Random(1)
        good = b"GET /api/labels HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
        for n in range(300):
            bytes_ = bytearray(good)
            for _ in range(rng.randint(1, 12)):
                bytes_[rng.randrange(len(bytes_))] = rng.randrange(256)
            if n % 10 == 0:
                bytes_ = bytearray(rng.randbytes(rng.randint(1, 4000)))
            with socket.create_connection(("127.0.0.1", self.server.port), timeout=5) as link:
                try:
                    link.sendall(bytes_[: rng.randint(1, len(bytes_))] if n % 3 == 0 else bytes_)
                except OSError:
                    pass
        self.assertEqual(self.server.ask("/api/labels")[0].status, 200)

    def test_slow_and_vanishing_clients_cost_a_connection_and_nothing_else(self):
        files, most = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(most, 8192), most))
        self.addCleanup(resource.setrlimit, resource.RLIMIT_NOFILE, (files, most))
        idle = [socket.create_connection(("127.0.0.1", self.server.port), timeout=5) for _ in range(3000)]
        for link in idle:
            link.sendall(b"GET /api/map HTTP/1.1\r\nHo")  # and never goes on
        streams = []
        for _ in range(80):
            link = socket.create_connection(("127.0.0.1", self.server.port), timeout=5)
            link.sendall(b"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            streams.append(link)
        answers = [link.recv(4096)[:12] for link in streams]
        self.assertIn(answers.count(b"HTTP/1.1 200"), range(60, 65))
        self.assertGreaterEqual(answers.count(b"HTTP/1.1 503"), 16)
        for link in idle[:20]:  # asks, and never takes the answer
            link.sendall(b"st: 127.0.0.1\r\n\r\n")
        self.assertEqual(self.server.ask("/api/labels")[0].status, 200)
        for link in idle + streams:
            link.close()
        self.assertEqual(self.server.ask("/api/labels")[0].status, 200)


class Live(unittest.TestCase):
    """A node that works, goes away and comes back."""

    def assert_its_past_is_remembered(self, state, whole):
        """Who begins to look when all is over sees how it came, as the node remembers it."""
        with Server("--node", state) as late:
            for _ in range(200):
                times = late.settled("live")["times_s"]
                if len(times) > 1:
                    break
                time.sleep(0.1)
            self.assertEqual(times, sorted(times))
            self.assertLess(times[0], 6, times)
            self.assertGreater(len(times), 3)
            counts = [len(tiles(late.ask(f"/api/map?at={t}")[1])[0]) for t in times]
            self.assertLess(counts[0], counts[1])
            self.assertLess(counts[1], counts[-1])
            self.assertEqual(counts, sorted(counts))
            self.assertEqual(late.json(f"/api/status?at={times[-1]}")["cells"], whole)
            held = late.json(f"/api/labels?at={times[-2]}")["labels"]
            self.assertGreater(len(held), 0)
            self.assertNotIn("sand", [row["name"] for row in late.json(f"/api/labels?at={times[1]}")["labels"]])  # that was said later
            events = late.json("/api/events")["events"]
            self.assertEqual(sorted(e["text"] for e in events if e["kind"] == "joined" and e["text"].startswith("R")),
                             ["R00 joined", "R01 joined", "R02 joined"], events)
            self.assertEqual([e for e in events if e["kind"] == "lost"], [])
            self.assertEqual(sum(e["kind"] == "edit" and '"sand"' in e["text"] for e in events), 1)
            tracks = {t["robot"]: t["points"] for t in late.json("/api/tracks")["tracks"]}
            self.assertLess(tracks["R00"][0][0], 13)  # of heartbeats it keeps one in ten
            self.assertGreater(len({tuple(p[1:]) for p in tracks["R00"]}), 1)
            traffic, status = late.json("/api/traffic"), late.json("/api/status")
            sent = {n["name"]: n["bytes_sent"] for n in status["nodes"]}
            for node in traffic["nodes"]:  # all that was ever sent, and not at once
                self.assertEqual(sum(sum(row[1:]) for row in node["bins"]), sent[node["node"]], node)
                if node["node"].startswith("R"):
                    self.assertGreater(len(node["bins"]), 5, node)

    def test_a_live_mission_is_followed(self):
        with tempfile.TemporaryDirectory(prefix="shoal_live_") as top:
            state = os.path.join(top, "state")
            url = ["--lcm-url", "udpm://239.255.76.68:7681?ttl=0", "--mission", "live"]
            logs = open(os.path.join(top, "log"), "wb")
            started = []

            def start(program, *arguments):
                started.append(subprocess.Popen([os.path.join(BIN, program), *arguments, *url], stdout=logs, stderr=logs))
                return started[-1]

            try:
                with Server("--node", state) as server:
                    mission = server.json("/api/mission")
                    self.assertEqual(mission["sequence"], 0)
                    self.assertEqual(server.ask("/api/map")[0].status, 503)
                    node = start("fusion_node", "--node", "OPERATOR", "--state", state)
                    for n in range(3):
                        start("robot_agent", "--robot", f"R0{n}", "--robots", "3", "--source", "reef:tuning", "--observations", "12",
                              "--budget", "0", "--rate", "4", "--out", os.path.join(top, "out"))
                    with socket.create_connection(("127.0.0.1", server.port), timeout=60) as stream:
                        stream.sendall(b"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
                        said = b""
                        while said.count(b'"phase":"live"') < 3:
                            said += stream.recv(4096)
                    for robot in started[1:]:
                        self.assertEqual(robot.wait(timeout=60), 0)
                    whole = json.loads(command("status", "--node", state, "--json"))["cells"]
                    for _ in range(100):
                        cells, header = tiles(server.ask("/api/map")[1])
                        if server.json("/api/status")["cells"] == whole:
                            break
                        time.sleep(0.1)
                    self.assertEqual(server.json("/api/status")["cells"], whole)
                    self.assertGreater(len(cells), 50)
                    key = {"Authorization": "Bearer " + server.token}
                    label = server.json("/api/labels")["labels"][0]["label"]
                    self.assertLess({"bricks", "heartbeat", "topics"}, set(server.json("/api/traffic")["classes"]))
                    # What a sharper picture costs, before it is asked for; asking takes the key.
                    while not server.json("/api/pictures")["labels"]:
                        time.sleep(0.1)
                    picture = next(p for row in server.json("/api/pictures")["labels"] for p in row["pictures"])
                    wish = {name: picture[name] for name in ("robot", "topic", "example")}
                    price = server.json("/api/ask?" + urllib.parse.urlencode(wish))
                    jsonschema.validate(price, schema("ask"))
                    told = json.loads(command("ask", wish["robot"], "example", str(wish["topic"]), "--number", str(wish["example"]), "--node", state,
                                              "--dry-run", "--json"))
                    self.assertEqual((price["bytes"], price["state"]), (told["bytes"], told["state"]))
                    self.assertEqual(server.ask("/api/ask", "POST", json.dumps(wish))[0].status, 401)
                    for wrong in ("", "robot=R00", "robot=R00&topic=1.5", "robot=R00&topic=99999999999", "label=nothing", "robot=R99&topic=0"):
                        self.assertEqual(server.ask("/api/ask?" + wrong)[0].status, 400, wrong)
                    for wrong in ("[]", "7", "{", "{}", '{"robot": 7, "topic": "x"}', '{"robot": "R00", "topic": 1e99}'):
                        self.assertEqual(server.ask("/api/ask", "POST", wrong, key)[0].status, 400, wrong)
                    edit = json.dumps({"edit": "name", "label": str(label), "text": "sand"})
                    self.assertEqual(server.ask("/api/edit", "POST", edit, key)[0].status, 200)
                    for _ in range(100):
                        if "sand" in [l["name"] for l in server.json("/api/labels")["labels"]]:
                            break
                        time.sleep(0.1)
                    self.assertIn("sand", [l["name"] for l in server.json("/api/labels")["labels"]])
                    before = None
                    while cells != before:  # what was repaired late has come
                        before = cells
                        time.sleep(2)
                        cells, _ = tiles(server.ask("/api/map")[1])
                    self.assert_its_past_is_remembered(state, whole)
                    node.send_signal(signal.SIGINT)
                    node.wait(timeout=20)
                    self.assertTrue(any(e["kind"] == "edit" and '"sand"' in e["text"] for e in server.json("/api/events")["events"]))
                    self.assertRegex(server.settled("lost")["problem"], "no running node|did not answer")
                    kept, header = tiles(server.ask("/api/map?cells=all")[1])
                    self.assertEqual(kept, cells)  # what was known is still shown
                    labels = server.json("/api/labels")
                # The node's memory of it is as good as a recording.
                (memory,) = [name for name in os.listdir(state) if name.endswith(".sqlite")]
                with Server("--log", os.path.join(state, memory)) as server:
                    server.settled()
                    again, remembered = tiles(server.ask("/api/map?cells=all")[1])
                    self.assertEqual(again, cells)
                    for what in ("surprises", "lower"):
                        self.assertEqual(remembered[what], header[what], what)
                    for theirs, ours in zip(server.json("/api/labels")["labels"], labels["labels"], strict=True):
                        del theirs["pictures"]
                        self.assertEqual(theirs, ours)
            finally:
                for process in started:
                    if process.poll() is None:
                        process.kill()
                        process.wait()
                logs.close()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
