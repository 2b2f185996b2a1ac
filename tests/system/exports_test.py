#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every export opened by the tools that it is for: GDAL, CloudCompare, liboctomap, the MCAP reader.

Usage: exports_test.py BIN_DIR READ_OCTREE WEB_DIR [unittest arguments]; WEB_DIR has mcap_read.mjs and its packages.
The mission is written by hand: seven columns of half a metre, one of two storeys, a hole in the middle.
"""
import base64
import csv
import io
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import jsonschema

BIN, READ_OCTREE, WEB = (os.path.abspath(p) for p in sys.argv[1:4])
CONSOLE = os.path.join(BIN, "operator_console")
SIZE = 0.5
SAND, CORAL = 4, 10007
NAMES = {SAND: "", CORAL: "coral <\"&'> \N{FISH}"}
# (i, j, k): label, robot, seen, certainty. A ring around (101, -49), and a second storey of another label.
CELLS = {(100 + i, -50 + j, 0): (SAND, 0, 10.0 + i, 0.25 * i + 0.125) for i in range(3) for j in range(3) if (i, j) != (1, 1)}
CELLS[102, -48, 0] = CORAL, 1, 20.0, 0.5
CELLS[100, -50, 1] = CORAL, 1, 21.5, 0.75
ORIGIN = (-17.53, 177.21)
# Seconds and metres; one place is no track.
TRACKS = {"R00": [(1.0, 50.0, -25.0, 5.0), (2.0, 51.0, -25.0, 5.5), (3.0, 51.0, -24.0, 4.25)], "R01": [(1.0, 49.0, -23.0, 4.0)]}


def run(*command, status=0, **options):
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, **options)
    if done.returncode != status:
        raise AssertionError(f"{command}: exit {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done


def top_cells():
    """By column, what is seen from above."""
    top = {}
    for (i, j, k), cell in sorted(CELLS.items(), key=lambda item: item[0][2]):
        top[i, j] = cell
    return top


def on_earth(x, y, heading):
    """Longitude and latitude from the radii of curvature of WGS 84: right to a millimetre within 100 m."""
    east = x * math.cos(math.radians(heading)) + y * math.sin(math.radians(heading))
    north = y * math.cos(math.radians(heading)) - x * math.sin(math.radians(heading))
    latitude = math.radians(ORIGIN[0])
    a, e2 = 6378137.0, 0.00669437999014
    w = math.sqrt(1 - e2 * math.sin(latitude) ** 2)
    meridian, normal = a * (1 - e2) / w ** 3, a / w
    mean = latitude + north / meridian / 2
    return (ORIGIN[1] + math.degrees(east / (normal * math.cos(mean + north / meridian / 2))),
            ORIGIN[0] + math.degrees(north / meridian))


class Exports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.top = tempfile.mkdtemp(prefix="shoal_exports_")
        cls.run_dir = os.path.join(cls.top, "run")
        os.mkdir(cls.run_dir)

        def write(name, text):
            with open(os.path.join(cls.run_dir, name), "w", encoding="utf-8", newline="") as file:
                file.write(text)

        write("global_map.csv", "x_m,y_m,z_m,label,robot,seen_s,certainty\n" + "".join(
            f"{SIZE * i:.3f},{SIZE * j:.3f},{SIZE * k:.3f},{label},R{robot:02d},{seen:.3f},{certainty:.4f}\n"
            for (i, j, k), (label, robot, seen, certainty) in sorted(CELLS.items())))
        rows = io.StringIO()
        table = csv.writer(rows, lineterminator="\n")
        table.writerow(["label", "name", "cells", "area_m2", "robots", "first_seen_s"])
        for label, name in NAMES.items():
            count = sum(cell[0] == label for cell in CELLS.values())
            table.writerow([label, name, count, f"{count * SIZE * SIZE:.3f}", "R00;R01", "0.000"])
        write("labels.csv", rows.getvalue())
        node = {"phase": "landed", "observation": 3, "num_observations": 4, "topics": 8, "cells": 9, "bytes_sent": 1, "budget": 2000,
                "queue_bytes": 0, "ms_per_frame": 1.0, "rejected": 0, "conflicts": 0, "heard_whole": True, "agreement": "none"}
        write("summary.json", json.dumps({
            "mission_id": 7, "cell_size_m": SIZE, "digest": {"state": "00" * 8, "map": "00" * 8},
            "nodes": [{"name": "R00", "heard_s": 30.5, "position_m": [50.0, -25.0, 3.0], **node},
                      {"name": "R01", "heard_s": 31.25, "position_m": [51.0, -24.0, 3.0], **node}]}))
        for robot, places in TRACKS.items():
            os.makedirs(os.path.join(cls.run_dir, "robots", robot))
            write(f"robots/{robot}/poses.txt", "".join(f"{t:.6f} {x} {y} {z} 1 0 0 0\n" for t, x, y, z in places))
        os.mkdir(os.path.join(cls.run_dir, "pictures"))
        write("pictures/pictures.json", json.dumps({"labels": [{"label": CORAL, "pictures": [
            {"robot": "R01", "topic": 7, "example": 0, "cell": [102, -48, 0], "seen_s": 20.0, "num_layers": 2, "layers": ["00"]}]}]}))
        labels = json.loads(run(CONSOLE, "labels", "--run", cls.run_dir, "--json").stdout)["labels"]
        cls.color = {row["label"]: tuple(bytes.fromhex(row["color"][1:])) for row in labels}

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.top)

    def export(self, format_, name, *options):
        path = os.path.join(self.top, name)
        told = json.loads(run(CONSOLE, "export", "--format", format_, "--out", path, "--run", self.run_dir, "--json", *options).stdout)
        self.assertEqual((told["format"], told["file"], told["files"][0], told["cells"]), (format_, path, path, len(CELLS)))
        for file in told["files"]:
            self.assertTrue(os.path.exists(file), file)
        return path

    def earth(self, heading=0):
        return "--origin", str(ORIGIN[0]), str(ORIGIN[1]), "--heading", str(heading)

    def pixels(self, path):
        """(x, y) -> value by GDAL's own conversion."""
        rows = run("gdal_translate", "-q", "-of", "XYZ", path, "/vsistdout/").stdout.split("\n")
        return {(float(x), float(y)): float(value) for x, y, value in (row.split() for row in rows if row)}

    def test_geotiff_of_labels(self):
        path = self.export("geotiff", "map.tif")
        told = json.loads(run("gdalinfo", "-json", path).stdout)
        self.assertEqual(told["size"], [3, 3])
        band, = told["bands"]
        self.assertEqual((band["type"], band["colorInterpretation"], band["noDataValue"]), ("Byte", "Palette", 0))
        self.assertEqual(told["geoTransform"], [49.75, 0.5, 0, -23.75, 0, -0.5])
        colors = [tuple(entry[:3]) for entry in band["colorTable"]["entries"][:3]]
        self.assertEqual(colors[1:], [self.color[SAND], self.color[CORAL]])
        self.assertIn(f"1: label {SAND}\n      2: {NAMES[CORAL]} ({CORAL})\n", run("gdalinfo", path).stdout)
        value = {SAND: 1, CORAL: 2}
        expected = {(SIZE * i, SIZE * j): 0.0 for i in range(100, 103) for j in range(-50, -47)}
        expected.update({(SIZE * i, SIZE * j): float(value[cell[0]]) for (i, j), cell in top_cells().items()})
        self.assertEqual(self.pixels(path), expected)

    def test_geotiff_of_certainty(self):
        self.export("geotiff", "sure.tif")
        path = os.path.join(self.top, "sure_certainty.tif")
        band, = json.loads(run("gdalinfo", "-json", path).stdout)["bands"]
        self.assertEqual((band["type"], band["description"]), ("Float32", "certainty"))
        self.assertTrue(math.isnan(float(band["noDataValue"])))
        pixels = self.pixels(path)
        self.assertTrue(math.isnan(pixels.pop((SIZE * 101, SIZE * -49))))
        self.assertEqual(pixels, {(SIZE * i, SIZE * j): cell[3] for (i, j), cell in top_cells().items()})

    def test_geotiff_on_earth(self):
        for heading in (0, 90, -33.5):
            path = self.export("geotiff", f"earth{heading}.tif", *self.earth(heading))
            self.assertIn("Transverse Mercator", json.loads(run("gdalinfo", "-json", path).stdout)["coordinateSystem"]["wkt"])
            for (i, j), cell in top_cells().items():
                longitude, latitude = on_earth(SIZE * i, SIZE * j, heading)
                said = run("gdallocationinfo", "-valonly", "-wgs84", path, f"{longitude:.10f}", f"{latitude:.10f}").stdout
                self.assertEqual(int(said), {SAND: 1, CORAL: 2}[cell[0]], (heading, i, j))

    def test_more_labels_than_a_byte_tells_apart(self):
        many = os.path.join(self.top, "many")
        shutil.copytree(self.run_dir, many)
        with open(os.path.join(many, "global_map.csv"), "w", encoding="utf-8") as cells, \
                open(os.path.join(many, "labels.csv"), "w", encoding="utf-8") as labels:
            cells.write("x_m,y_m,z_m,label,robot,seen_s,certainty\n")
            labels.write("label,name,cells,area_m2,robots,first_seen_s\n")
            for n in range(300):
                cells.write(f"{SIZE * n:.3f},0.000,0.000,{n},R00,1.000,1.0000\n")
                labels.write(f"{n},,1,0.250,R00,0.000\n")
        path = os.path.join(self.top, "many.tif")
        run(CONSOLE, "export", "--format", "geotiff", "--out", path, "--run", many)
        band, = json.loads(run("gdalinfo", "-json", path).stdout)["bands"]
        self.assertEqual((band["type"], band["colorTable"]["count"]), ("UInt16", 65536))
        self.assertEqual(self.pixels(path), {(SIZE * n, 0.0): n + 1.0 for n in range(300)})

    def test_geojson_and_its_style(self):
        path = self.export("geojson", "map.geojson")
        with open(path, encoding="utf-8") as file:
            local = json.load(file)
        by_label = {}
        for feature in local["features"]:
            by_label.setdefault(feature["properties"]["label"], []).append(feature)
        self.assertEqual({label: len(found) for label, found in by_label.items()}, {SAND: 1, CORAL: 2})
        path = self.export("geojson", "earth.geojson", *self.earth(90))
        said = run("ogrinfo", "-so", "-al", path).stdout
        self.assertIn("Feature Count: 3", said)
        self.assertIn("WGS 84", said)
        with open(path, encoding="utf-8") as file:
            earth = json.load(file)
        self.assertNotIn("coordinates_are", earth)
        for here, there in zip(local["features"], earth["features"], strict=True):
            self.assertEqual(here["properties"], there["properties"])
            for ring, turned in zip(here["geometry"]["coordinates"], there["geometry"]["coordinates"], strict=True):
                for (x, y), (longitude, latitude) in zip(ring, turned, strict=True):
                    expected = on_earth(x, y, 90)
                    self.assertAlmostEqual(longitude, expected[0], delta=2e-8)  # 2 mm
                    self.assertAlmostEqual(latitude, expected[1], delta=2e-8)
        style = xml.etree.ElementTree.parse(os.path.join(self.top, "map.qml")).getroot()
        renderer = style.find("renderer-v2")
        self.assertEqual((renderer.get("type"), renderer.get("attr")), ("categorizedSymbol", "label"))
        symbols = {s.get("name"): s.find("layer/Option/Option[@name='color']").get("value") for s in renderer.find("symbols")}
        styled = {int(c.get("value")): (c.get("label"), tuple(int(v) for v in symbols[c.get("symbol")].split(",")[:3]))
                  for c in renderer.find("categories")}
        self.assertEqual(styled, {SAND: (f"label {SAND}", self.color[SAND]), CORAL: (f"{NAMES[CORAL]} ({CORAL})", self.color[CORAL])})

    def test_kml(self):
        path = self.export("kml", "map.kml", *self.earth(90))
        self.assertIn("driver `LIBKML' successful", run("ogrinfo", path).stdout)
        layers = {}
        for line in run("ogrinfo", "-ro", "-q", path).stdout.splitlines():
            name = line.split(": ", 1)[1]
            read = run("ogr2ogr", "-f", "GeoJSON", "/vsistdout/", path, name).stdout
            layers[name.split(" (3D")[0]] = json.loads(read)["features"]
        self.assertEqual({name: len(found) for name, found in layers.items()},
                         {f"label {SAND}": 1, f"{NAMES[CORAL]} ({CORAL})": 2, "robots": 2, "tracks": 1})
        track = layers["tracks"][0]
        self.assertEqual((track["properties"]["Name"], track["geometry"]["type"]), ("R00", "LineString"))
        for (lon, lat, height), (_, x, y, z) in zip(track["geometry"]["coordinates"], TRACKS["R00"], strict=True):
            self.assertAlmostEqual(lon, on_earth(x, y, 90)[0], delta=2e-8)
            self.assertAlmostEqual(lat, on_earth(x, y, 90)[1], delta=2e-8)
            self.assertAlmostEqual(height, z, delta=1e-3)
        self.assertIn("altitudeMode", track["properties"])
        ring = layers[f"label {SAND}"][0]
        polygons = ring["geometry"]["coordinates"] if ring["geometry"]["type"] == "MultiPolygon" else \
            [g["coordinates"] for g in ring["geometry"]["geometries"]] if "geometries" in ring["geometry"] else [ring["geometry"]["coordinates"]]
        corners = {tuple(round(v, 8) for v in corner[:2]) for polygon in polygons for way in polygon for corner in way}
        west, south = on_earth(SIZE * 99.5, SIZE * -50.5, 90)
        self.assertTrue(any(math.hypot(x - west, y - south) < 3e-8 for x, y in corners), (corners, west, south))
        at = {f["properties"]["Name"]: f["geometry"]["coordinates"] for f in layers["robots"]}
        self.assertAlmostEqual(at["R01"][0], on_earth(51, -24, 90)[0], delta=2e-8)
        self.assertAlmostEqual(at["R01"][1], on_earth(51, -24, 90)[1], delta=2e-8)

    def test_ply_in_cloudcompare(self):
        path = self.export("ply", "map.ply")
        out = os.path.join(self.top, "points.asc")
        run("CloudCompare", "-SILENT", "-AUTO_SAVE", "OFF", "-C_EXPORT_FMT", "ASC", "-PREC", "6", "-SEP", "COMMA", "-ADD_HEADER",
            "-O", path, "-SAVE_CLOUDS", "FILE", out, env={**os.environ, "QT_QPA_PLATFORM": "offscreen", "HOME": self.top})
        with open(out, encoding="utf-8") as file:
            rows = list(csv.reader(file))
        self.assertEqual(rows[0], ["//X", "Y", "Z", "R", "G", "B", "label", "certainty", "robot", "age"])
        newest = max(cell[2] for cell in CELLS.values())
        expected = sorted([SIZE * i, SIZE * j, SIZE * k, *self.color[label], label, certainty, robot, newest - seen]
                          for (i, j, k), (label, robot, seen, certainty) in CELLS.items())
        self.assertEqual(sorted([float(v) for v in row] for row in rows[1:]), expected)

    def test_octree(self):
        path = self.export("octree", "map.ot")
        half = SIZE / 2
        read = {}
        for line in run(READ_OCTREE, path).stdout.splitlines():
            x, y, z, edge, *color, occupied = (float(v) for v in line.split())
            self.assertEqual(occupied, 1)
            count = round(edge / half)  # a leaf of several voxels
            low = [round((c - edge / 2) / half) for c in (x, y, z)]
            for n in range(count ** 3):
                read[low[0] + n % count, low[1] + n // count % count, low[2] + n // count ** 2] = tuple(int(c) for c in color)
        expected = {(2 * i - 1 + n % 2, 2 * j - 1 + n // 2 % 2, 2 * k - 1 + n // 4): self.color[cell[0]]
                    for (i, j, k), cell in CELLS.items() for n in range(8)}
        self.assertEqual(read, expected)

    def test_mcap(self):
        path = self.export("mcap", "map.mcap", *self.earth(90))
        messages = [json.loads(line) for line in run("node", "mcap_read.mjs", path, cwd=WEB).stdout.splitlines()]
        for m in messages:
            jsonschema.validate(m["message"], m["schema"])
        self.assertEqual([(m["topic"], m["schema_name"], int(m["time_ns"])) for m in messages], [
            (f"/pictures/{CORAL}", "foxglove.CompressedImage", 20_000_000_000),
            ("/tf", "foxglove.FrameTransform", 30_500_000_000), ("/robots/R00", "foxglove.LocationFix", 30_500_000_000),
            ("/tf", "foxglove.FrameTransform", 31_250_000_000), ("/robots/R01", "foxglove.LocationFix", 31_250_000_000),
            ("/map", "foxglove.PointCloud", 31_250_000_000), ("/labels", "shoal.Labels", 31_250_000_000),
            ("/status", "shoal.Status", 31_250_000_000)])
        said = {m["topic"]: m["message"] for m in messages}
        self.assertEqual(said["/tf"]["translation"], {"x": 51.0, "y": -24.0, "z": 3.0})
        self.assertAlmostEqual(said["/robots/R01"]["longitude"], on_earth(51, -24, 90)[0], delta=2e-8)
        self.assertTrue(base64.b64decode(said[f"/pictures/{CORAL}"]["data"]).startswith(b"\x89PNG"))
        self.assertEqual({row["label"]: row["name"] for row in said["/labels"]["labels"]}, NAMES)
        cloud = said["/map"]
        layout = {f["name"]: (f["offset"], {1: "<B", 3: "<H", 6: "<i", 7: "<f"}[f["type"]]) for f in cloud["fields"]}
        data = base64.b64decode(cloud["data"])
        points = [[struct.unpack_from(kind, data, at + offset)[0] for offset, kind in layout.values()]
                  for at in range(0, len(data), cloud["point_stride"])]
        self.assertEqual(list(layout), ["x", "y", "z", "red", "green", "blue", "alpha", "label", "certainty", "robot", "age"])
        self.assertEqual(sorted(points), sorted([SIZE * i, SIZE * j, SIZE * k, *self.color[label], 255, label, certainty, robot, 21.5 - seen]
                                                for (i, j, k), (label, robot, seen, certainty) in CELLS.items()))

    def test_same_map_same_bytes(self):
        for format_, options in (("geotiff", self.earth(12)), ("kml", self.earth()), ("octree", ()), ("mcap", ()), ("geojson", self.earth(1))):
            first, again = (self.export(format_, name, *options) for name in ("once", "again"))
            with open(first, "rb") as a, open(again, "rb") as b:
                self.assertEqual(a.read(), b.read(), format_)

    def test_an_empty_map(self):
        empty = os.path.join(self.top, "empty")
        shutil.copytree(self.run_dir, empty)
        for name in ("global_map.csv", "labels.csv"):
            path = os.path.join(empty, name)
            with open(path, encoding="utf-8") as file:
                header = file.readline()
            with open(path, "w", encoding="utf-8") as file:
                file.write(header)
        for format_ in ("geotiff", "kml", "octree", "mcap", "geojson", "ply"):
            path = os.path.join(self.top, "empty." + format_)
            run(CONSOLE, "export", "--format", format_, "--out", path, "--run", empty, *(self.earth() if format_ == "kml" else ()))
        self.assertEqual(json.loads(run("gdalinfo", "-json", os.path.join(self.top, "empty.geotiff")).stdout)["size"], [1, 1])
        self.assertEqual(run(READ_OCTREE, os.path.join(self.top, "empty.octree")).stdout, "")
        run("node", "mcap_read.mjs", os.path.join(self.top, "empty.mcap"), cwd=WEB)

    def test_wrong_origins_are_refused(self):
        out = ("--out", os.path.join(self.top, "no"), "--run", self.run_dir)
        for options, says in ((("--format", "kml"), "origin"), (("--format", "ply", *self.earth()), "takes no origin"),
                              (("--format", "geotiff", "--heading", "3"), "--origin"),
                              (("--format", "geotiff", "--origin", "90", "0"), "latitude.*90"),
                              (("--format", "geotiff", "--origin", "0", "181"), "longitude.*181"),
                              (("--format", "geotiff", "--origin", "nan", "0"), "latitude.*nan"),
                              (("--format", "geotiff", "--origin", "0", "0", "--heading", "400"), "heading.*400")):
            self.assertRegex(run(CONSOLE, "export", *options, *out, status=2).stderr, says)
        self.assertFalse(os.path.exists(os.path.join(self.top, "no")))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
