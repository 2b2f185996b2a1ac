# SPDX-License-Identifier: BSD-3-Clause
"""Payloads, one function a type. Each takes the message and adds to it, or puts lists in place of counts."""
import bisect
import math
import re

from . import cells
from .cell_field import CellField, Geometry
from .errors import BadMessage, require
from .layout import (HAVE_LANDED, MAX_CELLS, MAX_LABEL, MAX_LAYER, MAX_ROBOT, MAX_TIME, MAX_TOPIC, MAX_TOPICS,
                     MAX_VOCABULARY, MAX_WORDS, OPERATIONS, OPERATORS, PHASES, TRAFFIC_CLASSES)
from .range_coder import Bits, Models


def _read_heartbeat(m, payload):
    at = 0

    def varint():
        nonlocal at
        value = 0
        for shift in range(0, 70, 7):
            require(at < len(payload), "the payload ends early", "bad payload")
            byte = payload[at]
            at += 1
            value |= (byte & 127) << shift
            if byte < 128:
                require(byte or not shift, "a varint could be shorter", "not canonical")
                require(value < 2**64, "a varint above 64 bits", "bad payload")
                return value
        raise BadMessage("bad payload", "a varint above 64 bits")

    m["class_bytes"] = {name: varint() for name in TRAFFIC_CLASSES}
    robots, follows = [], 0
    for _ in range(varint()):
        first = follows + varint()
        follows = first + varint() + 1
        require(follows <= OPERATORS + 1 and len(robots) + follows - first <= 256, "roster", "bad payload")
        robots += range(first, follows)
    require(len(payload) - at >= 4 * len(robots), "the payload ends early", "bad payload")
    m["roster"] = [(robot, int.from_bytes(payload[at + 4 * i:at + 4 * i + 4], "big")) for i, robot in enumerate(robots)]
    at += 4 * len(robots)
    m["learnt"], m["battery_percent"], m["depth_cm"] = 0 if m["phase"] in HAVE_LANDED else None, None, None
    if at < len(payload):
        battery, depth = varint(), varint()
        require(battery <= 101 and depth <= 2**31, "battery or depth", "bad payload")
        if at < len(payload):
            require(len(payload) - at >= 4, "the payload ends early", "bad payload")
            learnt = int.from_bytes(payload[at:at + 4], "big")
            at += 4
            require(learnt, "what was learnt is 0", "not canonical")
            require(m["phase"] in HAVE_LANDED, "learnt, and not landed")
            m["learnt"] = learnt
        require(battery or depth or m["learnt"], "a battery and a depth that are not known", "not canonical")
        m["battery_percent"], m["depth_cm"] = battery - 1 if battery else None, depth - 1 if depth else None
    require(at == len(payload), "bytes after the end of the payload", "not canonical")
    require(all(count < 2**63 for count in m["class_bytes"].values()), "class_bytes")
    require(m["phase"] < len(PHASES) and m["epoch"] >= 0 and m["observation"] >= -1, "phase, epoch or observation")
    require(0 <= m["num_topics"] <= MAX_TOPIC + 1, "num_topics")
    for name in ("num_observations", "num_cells", "pid", "bytes_sent", "budget", "queue_bytes", "rejected",
                 "conflicts"):
        require(m[name] >= 0, name)
    for name in ("x_m", "y_m", "z_m", "ms_per_frame", "cell_size_m"):
        require(math.isfinite(m[name]), name)
    require(m["ms_per_frame"] >= 0 and m["cell_size_m"] > 0, "ms_per_frame or cell_size_m")
    m["phase"] = PHASES[m["phase"]]


def topic_headers(m, bits):
    """Which topics a message holds, of what versions and with how many words, as dicts; the first is in its fields."""
    def zigzag(coded):
        return -(coded + 1) // 2 if coded & 1 else coded // 2

    names = ("part", "num_parts", "observation", "topic", "num_words")
    headers = [{name: m[name] for name in names}]
    more, gaps, versions, lengths, is_part = Models(), Models(), Models(), Models(), [64000, 10]
    require(0 <= m["topic"] <= MAX_TOPIC, "topic")
    require(0 <= m["num_words"] <= MAX_WORDS, "num_words")
    count = bits.small(more)
    require(count < MAX_TOPICS, "topics", "bad payload")
    for _ in range(count):
        before = headers[-1]
        topic = before["topic"] + 1 + bits.small(gaps)
        observation = before["observation"] + zigzag(bits.small(versions))
        parts, part = (bits.direct(8), bits.direct(8)) if bits.bit(is_part) else (None, 0)
        require(parts is None or parts >= 2, "parts", "bad payload")
        require(topic <= MAX_TOPIC and 0 <= observation < 2**31, "topic or version", "bad payload")
        require(part < (parts or 1), "part")
        headers.append(dict(zip(names, (part, parts or 1, observation, topic, bits.long(lengths)))))
    require(sum(header["num_words"] for header in headers) <= MAX_WORDS, "num_words", "bad payload")
    return headers


def _read_topics(m, payload):
    bits = Bits(payload)
    topics = topic_headers(m, bits)
    for name in ("part", "num_parts", "observation", "topic", "num_words"):
        del m[name]
    sizes, ends = [], []
    for _ in range(bits.direct(6) + 1):
        sizes.append(bits.wide())
        ends.append(sum(sizes))
        require(sizes[-1] > 0 and ends[-1] <= MAX_VOCABULARY, "sizes of word groups", "bad payload")
    period = bits.wide()
    require(1 <= period <= MAX_TIME, "period of the times", "bad payload")
    created_models, weight_models, unit_models = Models(), Models(), Models()
    gaps = [Models() for _ in range(4)]
    counts = [[Models() for _ in range(4)] for _ in range(4)]

    def group_of(word):
        require(word < ends[-1], "a word outside the vocabulary", "bad payload")
        return min(bisect.bisect_right(ends, word), 3)

    for topic in topics:
        topic["created_us"] = period * bits.long(created_models)
        topic["weight"], unit = bits.long(weight_models), bits.long(unit_models)
        require(topic["created_us"] <= MAX_TIME, "created", "bad payload")
        require(topic["num_words"] <= ends[-1], "more words than the vocabulary has", "bad payload")
        require(1 <= unit < 2**31, "unit of the counts", "bad payload")
        words, follows, last = [], 0, 0
        for _ in range(topic["num_words"]):
            word = follows + bits.small(gaps[group_of(follows)])
            count = bits.small(counts[group_of(word)][last])
            require(count < (2**31 - 1) // unit, "a count", "bad payload")
            words.append((word, (count + 1) * unit))
            follows, last = word + 1, min(count.bit_length(), 3)
        require(unit == (math.gcd(*(count for _, count in words)) or 1), "unit of the counts", "bad payload")
        topic["group_sizes"], topic["words"] = sizes, words
    bits.end()
    divisor = math.gcd(*(topic["created_us"] for topic in topics)) or 1
    require(period == divisor, "period of the times", "not canonical")
    for topic in topics:
        require(topic["weight"] <= MAX_TIME, "weight")
        require(topic["weight"] or not topic["words"], "a retired topic has no words")
    m["topics"] = topics


def brick_headers(bits, count):
    """Which bricks a message holds and of what versions, as dicts."""
    x_models, y_models, row_models, above_models, z_models, version_models = (Models() for _ in range(6))
    is_part, headers = [64000, 10], []

    def zigzag(coded):
        return -(coded + 1) // 2 if coded & 1 else coded // 2

    for i in range(count):
        if i == 0:
            x, y, z = (zigzag(bits.wide() & 0xFFFFFFFF) for _ in range(3))
            observation = bits.wide()
            row_y = y
        else:
            step = bits.small(x_models)
            was, before = y, z
            y = y + bits.small(y_models) if step == 0 else row_y + zigzag(bits.small(row_models))
            x += step
            row_y = y if step else row_y
            z = z + 1 + bits.small(above_models) if step == 0 and y == was else before + zigzag(bits.small(z_models))
            observation += zigzag(bits.small(version_models))
        part, num_parts = 0, 1
        if bits.bit(is_part):
            num_parts, part = bits.direct(8), bits.direct(8)
            require(num_parts >= 2, "parts", "bad payload")
        require(all(-2**27 <= index < 2**27 for index in (x, y, z)), "a brick", "bad payload")
        require(0 <= observation < 2**31, "a version", "bad payload")
        require(part < num_parts, "part")
        header = {"part": part, "num_parts": num_parts, "observation": observation, "brick_x": x, "brick_y": y,
                  "brick_z": z}
        if headers:
            last = headers[-1]
            require((last["brick_x"], last["brick_y"], last["brick_z"]) < (x, y, z), "the order of bricks", "bad payload")
        headers.append(header)
    return headers


def _where(bits, m, count):
    """The headers of all bricks, the field of their cells, and where each brick's cells begin and end."""
    require(1 <= m[count] <= 1024, count)
    require(0 <= m["robot"] <= MAX_ROBOT and m["epoch"] >= 0, "robot or epoch")
    bricks, field, geometry, ranges = brick_headers(bits, m[count]), CellField(), Geometry(), []
    for brick in bricks:
        begin = len(field.cells)
        geometry.read(bits, (brick["brick_x"], brick["brick_y"], brick["brick_z"]), field)
        require(begin < len(field.cells) <= MAX_CELLS, "cells of a brick", "bad payload")
        ranges.append((begin, len(field.cells)))
    return bricks, field, ranges


def _read_bricks(m, payload):
    bits = Bits(payload)
    bricks, field, ranges = _where(bits, m, "bricks")
    topics = cells.column(bits, field, MAX_TOPIC, MAX_CELLS)
    times = cells.times(bits, field, MAX_CELLS)
    bits.end()
    for brick, (begin, end) in zip(bricks, ranges):
        brick["cells"] = list(zip(field.cells[begin:end], topics[begin:end], times[begin:end]))
    m["bricks"] = bricks


def _read_certainties(m, payload):
    bits = Bits(payload)
    bricks, field, ranges = _where(bits, m, "certain_bricks")
    steps, surprises = cells.certainties(bits, field), cells.surprises(bits, field)
    bits.end()
    for brick, (begin, end) in zip(bricks, ranges):
        brick["certainties"] = list(zip(field.cells[begin:end], steps[begin:end], surprises[begin:end]))
    m["certain_bricks"] = bricks


def _read_matches(m, payload):
    count, entries = m["correspondences"], []
    require(0 <= count <= 16384, "correspondences")
    require(count or not payload, "bytes after the end of the payload", "not canonical")
    if count:
        bits = Bits(payload)
        labels = cells.palette(bits, MAX_LABEL, count)
        width = (len(labels) - 1).bit_length()
        robot_models, topic_models, label_models = Models(), Models(), Models()
        robot, follows = 0, 0
        for _ in range(count):
            skip = bits.small(robot_models)
            if skip:
                robot, follows = robot + skip, 0
            topic = follows + bits.small(topic_models)
            which = bits.tree(label_models, width)
            require(robot <= MAX_ROBOT and topic <= MAX_TOPIC and which < len(labels), "an entry", "bad payload")
            entries.append((robot, topic, labels[which]))
            follows = topic + 1
        bits.end()
    m["correspondences"] = entries


def _read_labels(m, payload):
    require(0 <= m["labels"] <= 4096, "labels")
    bits, rows, follows = Bits(payload), [], 0
    label_models, cell_models, count_models, robot_models, letters = (Models() for _ in range(5))
    for _ in range(m["labels"]):
        label = follows + bits.long(label_models)
        follows = label + 1
        cells, first_seen = bits.long(cell_models), bits.wide()
        count, robots, next_robot = bits.small(count_models), [], 0
        require(label <= MAX_LABEL and cells <= MAX_TIME, "label or cells", "bad payload")
        require(first_seen <= MAX_TIME and count <= 256, "first seen or robots", "bad payload")
        for _ in range(count):
            robots.append(next_robot + bits.small(robot_models))
            next_robot = robots[-1] + 1
            require(next_robot <= MAX_ROBOT + 1, "a robot", "bad payload")
        length = bits.direct(7)
        require(length <= 64, "length of a name", "bad payload")
        raw = bytes(bits.tree(letters, 8) for _ in range(length))
        name = _name(raw)
        rows.append({"label": label, "name": name, "cells": cells, "robots": robots, "first_seen_us": first_seen})
    bits.end()
    m["labels"] = rows


def _read_map(m, payload):
    count = m["fused_cells"]
    require(0 <= count <= 4096, "fused_cells")
    if not count:
        alone = m["num_chunks"] == 1 and not any(m["brick_" + axis] for axis in "xyz")
        require(alone, "a chunk is empty, and not the only one")
        require(not payload, "bytes after the end of the payload", "not canonical")
        m["fused_cells"] = []
        return
    bits = Bits(payload)
    field = CellField()
    Geometry().read(bits, (m["brick_x"], m["brick_y"], m["brick_z"]), field)
    require(len(field.cells) == count, f"{len(field.cells)} cells, {count} were announced", "bad payload")
    labels = cells.column(bits, field, MAX_LABEL, 4096)
    robots = cells.column(bits, field, MAX_ROBOT, 4096)
    times = cells.times(bits, field, 4096)
    steps = cells.certainties(bits, field)
    bits.end()
    m["fused_cells"] = list(zip(field.cells, labels, robots, times, steps))


def _read_picture(m, payload):
    require(0 <= m["topic"] <= MAX_TOPIC and m["example"] <= 7 and m["num_parts"] <= 4, "topic, example or layers")
    m["cell"] = tuple(m.pop("cell_" + axis) for axis in "xyz")
    m["seen_us"] = m.pop("seen")
    require(0 <= m["seen_us"] <= MAX_TIME, "seen")
    require(len(payload) <= MAX_LAYER and (payload or m["num_parts"] == 1), "length of a layer")
    m["layer"] = list(payload)


def _read_settings(m, payload):
    require(not payload, "settings have no payload", "bad payload")
    require(0 <= m["robot"] <= MAX_ROBOT and m["epoch"] >= 0, "robot or epoch")
    require(math.isfinite(m["cell_size_m"]) and m["cell_size_m"] > 0, "cell_size_m")


def _read_edit(m, payload):
    require(m["operation"] < len(OPERATIONS), "operation")
    fields = {name: m.pop(name) for name in ("robot", "epoch", "topic", "other_robot", "other_epoch", "other_topic",
                                             "undone")}
    m["operation"] = operation = OPERATIONS[m["operation"]]
    m["made_us"] = m.pop("made")
    at = 0

    def text():
        nonlocal at
        require(at < len(payload) and at + 1 + payload[at] <= len(payload), "the payload ends early", "bad payload")
        raw, at = payload[at + 1:at + 1 + payload[at]], at + 1 + payload[at]
        return raw

    def author(raw):
        require(re.fullmatch(b"[A-Z0-9]{1,16}", raw), "an author is 1 to 16 capitals and digits")
        return raw.decode()

    def topic(prefix):
        t = [fields[prefix + name] for name in ("robot", "epoch", "topic")]
        require(0 <= t[0] <= MAX_ROBOT and t[1] >= 0 and 0 <= t[2] <= MAX_TOPIC, "a topic")
        used.update(prefix + name for name in ("robot", "epoch", "topic"))
        return t

    said, used = text(), set()
    if operation in ("name", "undo"):
        more = text()
    require(at == len(payload), "bytes after the end of the payload", "bad payload")
    m["author"] = author(said)
    require(m["counter"] >= 1 and 0 <= m["made_us"] <= MAX_TIME, "counter or time")
    if operation == "name":
        m["topics"] = [topic("")]
        m["name"] = _name(more)
    elif operation in ("link", "unlink"):
        m["topics"] = [topic(""), topic("other_")]
        require(m["topics"][0] < m["topics"][1], "topics are not ascending")
    elif operation == "exclude":
        m["robot"] = fields["robot"]
        require(0 <= m["robot"] <= MAX_ROBOT, "robot")
        used.add("robot")
    else:
        m["undone"] = [author(more), fields["undone"]]
        require(fields["undone"] >= 1, "undone")
        used.add("undone")
    require(all(value == 0 for name, value in fields.items() if name not in used), "an unused field", "not canonical")


def _name(raw):
    require(len(raw) <= 64, "a name is above 64 bytes")
    try:
        name = raw.decode()
    except UnicodeDecodeError:
        raise BadMessage("field out of range", "a name is not UTF-8") from None
    require(not re.search("[\0-\x1f\x7f-\x9f]", name), "a name has control characters")
    return name


def _read_request(m, payload):
    m["talk"] = payload.hex()


READ = {"HEARTBEAT": _read_heartbeat, "TOPICS": _read_topics, "BRICK": _read_bricks, "CERTAINTY": _read_certainties,
        "MATCHES": _read_matches, "LABELS": _read_labels, "MAP": _read_map,
        "EDIT": _read_edit, "PICTURE": _read_picture, "SETTINGS": _read_settings, "REQUEST": _read_request}
