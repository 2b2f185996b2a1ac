# SPDX-License-Identifier: BSD-3-Clause
"""What stands behind the messages of a team with a key: session (4), counter (4), tag (8)."""
import hashlib
import hmac
import re
import struct

from .errors import BadFile, BadMessage, require
from .layout import LAYOUT
from .message import peek

SEAL = 16


def read_key(path):
    """The 32 bytes of a key file. BadFile when it is none."""
    try:
        with open(path, "rb") as file:
            text = file.read(200)
    except OSError as error:
        raise BadFile(f"cannot read {path}: {error.strerror}") from None
    match = re.fullmatch(rb"shoal-key-1 ([0-9a-fA-F]{64})\n", text)
    if not match:
        raise BadFile(f"{path} is no key file; make one with: operator_console keygen FILE")
    return bytes.fromhex(match.group(1).decode())


def tag(key, channel, data, session, counter):
    """Eight bytes that who lacks the key cannot make."""
    name = channel.encode("latin-1")
    text = bytes([len(name)]) + name + struct.pack(">II", session, counter) + data
    return hashlib.blake2b(text, digest_size=16, key=key, person=b"Shoal seal 1").digest()[:8]


def is_sealed(data):
    """Whether a seal stands behind what the message declares as its own length."""
    try:
        kind, _, _ = peek(data)
    except BadMessage:
        return False
    size = LAYOUT[kind].size
    return len(data) >= size and len(data) - size - struct.unpack_from(">i", data, size - 4)[0] == SEAL


def unsealed(channel, data, key=None):
    """The message without its seal, if it has one. With a key, BadMessage unless the seal is right."""
    data = bytes(data)
    if key is None:
        return data[:-SEAL] if is_sealed(data) else data
    body, seal = data[:-SEAL], data[-SEAL:]
    require(len(seal) == SEAL and len(channel) < 64, f"{len(data)} bytes", "not of our key")
    session, counter = struct.unpack_from(">II", seal)
    require(hmac.compare_digest(tag(key, channel, body, session, counter), seal[8:]), channel, "not of our key")
    return body
