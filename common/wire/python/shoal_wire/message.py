# SPDX-License-Identifier: BSD-3-Clause
"""One message: checked from the outside to the inside, then decoded."""
import binascii
import re
import struct

from .errors import require
from .layout import FIELDS, FINGERPRINTS, FORMAT, KINDS, LAYOUT, MASK, MAX_MESSAGE, MAX_ROBOT, MAX_TIME, PIECE_KINDS, UNSIGNED
from .payloads import READ, brick_headers, topic_headers
from .range_coder import Bits


def peek(data):
    """(kind, utime, mission) of a message; says nothing about whether the rest is good."""
    require(len(data) <= MAX_MESSAGE, f"{len(data)} bytes", "too long")
    require(len(data) >= 20, f"{len(data)} bytes", "too short")
    value, utime, mission = struct.unpack_from(">Qqi", data)
    kind = KINDS.get(value)
    require(kind is not None, f"fingerprint {value:016x} is of no type of ours", "wrong type")
    require(0 <= utime <= MAX_TIME, "utime")
    return kind, utime, mission


def unframe(data):
    """The fixed fields of a message, checked, and its payload as it is: (fields, payload)."""
    kind, _, _ = peek(data)
    layout = LAYOUT[kind]
    require(len(data) >= layout.size, f"{len(data)} bytes", "too short")
    values = layout.unpack_from(data)
    n = values[-1]
    require(0 <= n <= len(data) - layout.size, f"n is {n}", "bad length")
    require(n == len(data) - layout.size, f"n is {n}", "trailing bytes")
    require(values[3] == FORMAT, f"format {values[3]}, this reads {FORMAT}", "unknown format")
    blank = data[:layout.size - 6] + b"\0\0" + data[layout.size - 4:]
    require(binascii.crc_hqx(blank, 0xFFFF) == values[-2], "the message is damaged", "checksum")
    m = {"kind": kind, "utime": values[1], "mission": values[2]}
    for (name, _), value in zip(FIELDS[kind], values[4:]):
        m[name] = value & MASK if name in UNSIGNED else value
    if "part" in m:
        require(0 <= m["robot"] <= MAX_ROBOT and m["epoch"] >= 0 and m["observation"] >= 0, "robot or version")
        require(m["part"] < m["num_parts"], "part")
    if "brick_x" in m:
        require(all(-2**27 <= m["brick_" + axis] < 2**27 for axis in "xyz"), "brick")
    if "chunk" in m:
        require(0 <= m["chunk"] < m["num_chunks"], "chunk")
    return m, data[layout.size:]


def decode(data):
    """A message as a dict: "kind", the fields of its type in lcmtypes/*.lcm, and what its payload holds.

    HEARTBEAT: class_bytes {class: bytes}, roster [(robot, digest)]. TOPICS: topics, dicts of part, num_parts,
    observation, topic, num_words, created_us, weight, group_sizes and words [(word, count)]. BRICK: bricks, dicts of
    part, num_parts, observation, brick_x, y, z and cells [((x, y, z), topic, seen_us)]. CERTAINTY: certain_bricks, with
    certainties [((x, y, z), steps)]. MAP: fused_cells [((x, y, z), label, robot, seen_us, steps)]. MATCHES:
    correspondences [(robot, topic, label)]. EDIT: operation, author, counter, made_us, and topics [[robot, epoch,
    topic]], name, robot or undone [author, counter]. PICTURE: cell (x, y, z), seen_us, layer [bytes]. REQUEST: talk in
    hexadecimal. REPAIR: what the piece's own message holds. LABELS: labels [{label, name, cells, robots, first_seen_us}].

    Raises BadMessage, whatever the bytes are.
    """
    m, payload = unframe(bytes(data))
    if m["kind"] == "REPAIR":
        return {**decode(repaired(m, payload)), "kind": "REPAIR"}
    READ[m["kind"]](m, payload)
    return m


def pieces_of(m):
    """The pieces of state in a decoded message of a kind of pieces but EDIT, as content_hash() takes them."""
    if m["kind"] == "SETTINGS":
        return [{"part": 0, "num_parts": 1, **m}]
    if m["kind"] == "PICTURE":
        return [m]
    lists = {"TOPICS": "topics", "BRICK": "bricks", "CERTAINTY": "certain_bricks"}
    return [{"kind": m["kind"], "robot": m["robot"], "epoch": m["epoch"], **one} for one in m[lists[m["kind"]]]]


def keys_of(data):
    """(index, version, part) of each of pieces_of(decode(data)), without decoding all of it."""
    m, payload = unframe(data)
    if m["kind"] == "SETTINGS":
        return [((0,), (m["epoch"], 0), 0)]
    if m["kind"] == "PICTURE":
        return [((m["topic"], m["example"]), (m["epoch"], m["observation"]), m["part"])]
    if m["kind"] == "TOPICS":
        return [((t["topic"], 0), (m["epoch"], t["observation"]), t["part"]) for t in topic_headers(m, Bits(payload))]
    count = m["bricks" if m["kind"] == "BRICK" else "certain_bricks"]
    require(1 <= count <= 1024, "bricks")
    return [((b["brick_x"], b["brick_y"], b["brick_z"]), (m["epoch"], b["observation"]), b["part"])
            for b in brick_headers(Bits(payload), count)]


def repaired(m, payload):
    """The piece's own message that a REPAIR, as unframe() gives it, says again."""
    require(m["piece_kind"] in PIECE_KINDS, f"piece_kind is {m['piece_kind']}")
    kind = PIECE_KINDS[m["piece_kind"]]
    own = LAYOUT[kind].size - 27  # between the front, 21 bytes, and checksum and n
    require(len(payload) >= own, f"{len(payload)} bytes", "too short")
    front = struct.pack(">QqiB", FINGERPRINTS[kind], m["utime"], m["mission"], FORMAT) + payload[:own]
    rest = struct.pack(">i", len(payload) - own)
    rest += payload[own:]
    return front + struct.pack(">H", binascii.crc_hqx(front + b"\0\0" + rest, 0xFFFF)) + rest


def parse_datagram(packet):
    """(channel, message) of an LCM datagram as UDP delivers it, or BadMessage. Fragments are never ours."""
    require(packet[:4] == b"LC02" and len(packet) >= 9, "no LCM datagram that is whole", "wrong type")
    end = packet.find(b"\0", 8, 8 + 64)
    require(end >= 0, "no channel", "wrong type")
    return packet[8:end].decode("latin-1"), packet[end + 1:]


def parse_channel(channel):
    """(node, kind) of SHOAL_<NODE>_<KIND>; None for channels of others."""
    match = re.fullmatch(r"SHOAL_([A-Z0-9]{1,16})_([A-Z]+)", channel)
    return match.groups() if match else None


def robot_name(number):
    return f"R{number:02d}"
