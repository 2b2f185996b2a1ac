# SPDX-License-Identifier: BSD-3-Clause
"""The types of messages: their fields as in lcmtypes/*.lcm, their limits, and LCM's fingerprints."""
import struct

MAX_MESSAGE = 1391
MAX_TIME = 2**62 - 1
MAX_ROBOT = MAX_TOPIC = 9999
OPERATORS = 10000  # what operators decided is a share of the state beside those of the robots
MAX_LABEL = 99999999
MAX_VOCABULARY = 2**20
MAX_CELLS = 32768  # of all bricks in a message
MAX_PLACES = 131072  # asked about, is there a cell?
MAX_WORDS, MAX_TOPICS = 65536, 256  # of a message
FORMAT = 3
MAX_LAYER = 540  # bytes of a picture in one message
STEPS = 63  # certainties are in steps of 1/63
LEAST_SURPRISE = 12  # surprises in steps of 1/8, this many at least, or 0
MASK = 2**64 - 1  # hashes, digests and fingerprints are 64 bits

# Channel kind -> the fields between `format` and `checksum` as (name, struct code).
_PIECE = [("part", "B"), ("num_parts", "B"), ("robot", "h"), ("epoch", "i"), ("observation", "i")]
_BRICK = [("brick_x", "i"), ("brick_y", "i"), ("brick_z", "i")]
_CHUNK = [("chunk", "h"), ("num_chunks", "h")]
FIELDS = {
    "HEARTBEAT": [
        ("phase", "B"), ("epoch", "i"), ("observation", "i"), ("num_observations", "i"), ("num_topics", "h"),
        ("num_cells", "i"), ("own_digest", "q"), ("state_digest", "q"), ("map_digest", "q"), ("map_of_state", "q"),
        ("vocabulary", "q"), ("cell_size_m", "d"), ("host", "i"), ("pid", "i"), ("x_m", "f"), ("y_m", "f"),
        ("z_m", "f"), ("bytes_sent", "q"), ("budget", "i"), ("queue_bytes", "i"), ("rejected", "i"),
        ("conflicts", "i"), ("ms_per_frame", "f")],
    "TOPICS": _PIECE + [("topic", "h"), ("num_words", "i")],
    "BRICK": [("robot", "h"), ("epoch", "i"), ("bricks", "h")],
    "CERTAINTY": [("robot", "h"), ("epoch", "i"), ("certain_bricks", "h")],
    "MATCHES": [("map_digest", "q")] + _CHUNK + [("correspondences", "i")],
    "LABELS": [("map_digest", "q")] + _CHUNK + [("labels", "h")],
    "EDIT": [
        ("operation", "B"), ("made", "q"), ("counter", "i"), ("robot", "h"), ("epoch", "i"), ("topic", "h"),
        ("other_robot", "h"), ("other_epoch", "i"), ("other_topic", "h"), ("undone", "i")],
    "PICTURE": _PIECE + [
        ("topic", "h"), ("example", "B"), ("cell_x", "i"), ("cell_y", "i"), ("cell_z", "i"), ("seen", "q")],
    "SETTINGS": [("robot", "h"), ("epoch", "i"), ("words", "q"), ("hyperparameters", "q"), ("cell_size_m", "d")],
    "REQUEST": [],
    "REPAIR": [("piece_kind", "B")],
    "MAP": [("map_digest", "q"), ("chunk", "i"), ("num_chunks", "i")] + _BRICK + [("fused_cells", "h")],
}
LAYOUT = {kind: struct.Struct(">qqiB" + "".join(code for _, code in fields) + "Hi") for kind, fields in FIELDS.items()}
_LCM_TYPE = {"q": "int64_t", "i": "int32_t", "h": "int16_t", "B": "byte", "d": "double", "f": "float"}
PIECE_KINDS = {1: "TOPICS", 2: "BRICK", 3: "CERTAINTY", 4: "EDIT", 5: "PICTURE", 6: "SETTINGS"}  # of repairs
TRAFFIC_CLASSES = ["heartbeat", "matches", "topics", "bricks", "certainty", "pictures", "local"]
OPERATIONS = ["name", "link", "unlink", "exclude", "undo"]
PHASES = ["flying", "landed", "leaving", "node", "listening"]
HAVE_LANDED = (1, 2, 4)
UNSIGNED = {"own_digest", "state_digest", "map_digest", "map_of_state", "vocabulary", "words", "hyperparameters"}


def fingerprint(members):
    """LCM's fingerprint of a type, from its members as (name, type, size member of a one-dimensional array or None)."""
    value = 0x12345678

    def update(byte):
        nonlocal value
        signed = value - 2**64 if value >> 63 else value
        value = ((value << 8 ^ signed >> 55) + byte) & MASK

    def update_text(text):
        update(len(text))
        for letter in text.encode():
            update(letter)

    for name, lcm_type, size in members:
        update_text(name)
        update_text(lcm_type)
        update(0 if size is None else 1)
        if size is not None:
            update(1)  # sized by a member
            update_text(size)
    return (value << 1 | value >> 63) & MASK


def members(kind):
    """The members of a type as fingerprint() takes them."""
    front = [("utime", "int64_t", None), ("mission", "int32_t", None), ("format", "byte", None)]
    own = [(name, _LCM_TYPE[code], None) for name, code in FIELDS[kind]]
    return front + own + [("checksum", "int16_t", None), ("n", "int32_t", None), ("payload", "byte", "n")]


FINGERPRINTS = {kind: fingerprint(members(kind)) for kind in FIELDS}
KINDS = {value: kind for kind, value in FINGERPRINTS.items()}
