# SPDX-License-Identifier: BSD-3-Clause
"""The state that messages add up to, and the fused map."""
import collections

from .digests import content_hash, edit_hash, hash_of, map_digest
from .errors import BadFile, BadMessage, require
from .layout import LAYOUT, MASK, OPERATORS
from .log import Log
from .message import decode, keys_of, parse_channel, peek, pieces_of, repaired, robot_name, unframe
from .seal import unsealed


class _Lists:
    """Chunks of what one node publishes about its maps, by kind: the maps it named last, and what came of them."""

    def __init__(self):
        self.by_digest = collections.OrderedDict()  # digest -> {chunk: raw}, the latest heard last

    def hear(self, m, raw):
        chunks = self.by_digest.setdefault(m["map_digest"], {})
        chunks.setdefault(m["chunk"], raw)
        self.by_digest.move_to_end(m["map_digest"])
        if len(chunks) == m["num_chunks"]:  # whole: what is older is of no use any more
            while next(iter(self.by_digest)) != m["map_digest"]:
                self.by_digest.popitem(last=False)

    def whole(self, digest):
        """The decoded chunks of what belongs to a map, in order; None unless all have come."""
        try:
            chunks = [decode(raw) for _, raw in sorted(self.by_digest.get(digest, {}).items())]
        except BadMessage:
            return None
        whole = chunks and len(chunks) == chunks[0]["num_chunks"]
        return chunks if whole else None

    def newest(self):
        """The digest of the map of which all chunks have come, and one of them last; None when there is none."""
        return next((digest for digest in reversed(self.by_digest) if self.whole(digest) is not None), None)


def _content(data):
    """All of a message but when it was sent and its checksum."""
    fixed = LAYOUT[peek(data)[0]].size
    return data[:8], data[16:fixed - 6], data[fixed:]


class Mission:
    """What the messages of one mission add up to. What is bad is counted by reason in `refused` and left out."""

    def __init__(self, mission, key=None):
        self.mission = mission
        self._key = key
        self.refused = collections.Counter()
        self.heard = 0
        self.heartbeats = {}  # node -> the latest
        self._versions = {}   # (robot, kind, index) -> {(epoch, observation): [(raw, place in it), as they came]}
        self._times = collections.Counter()    # content -> how often it was heard
        self._bad = {}        # content -> Counter of what is wrong with it, for each time that it is heard
        self._decoded = {}    # raw -> its pieces, or None when it is bad
        self._usable = None
        self._digests = {}
        self._lists = {}      # (node, kind) -> _Lists
        self._edits = {}      # edit_hash -> decoded

    def hear(self, channel, data):
        """Takes in a message that came on a channel, with its seal or without."""
        try:
            known = parse_channel(channel)
            require(known, channel, "channel")
            node, channel_kind = known
            data = unsealed(channel, data, self._key)
            kind, _, mission = peek(data)
            require(kind == channel_kind, f"{kind} on {channel}", "wrong type")
            require(mission == self.mission, str(mission), "other mission")
            m, _ = unframe(data)
            if kind == "HEARTBEAT":
                m = decode(data)
                held = self.heartbeats.get(node, m)
                if (m["epoch"], m["utime"]) >= (held["epoch"], held["utime"]):
                    if m["epoch"] > held["epoch"]:
                        self._usable, self._digests = None, {}
                    self.heartbeats[node] = m
            elif kind == "REPAIR":  # whoever made the piece, any node may say it again
                data = repaired(*unframe(data))
                m, _ = unframe(data)
                if m["kind"] == "EDIT":
                    self._hear_edit(data)
                else:
                    self._hear_piece(m, data)
            elif kind in ("TOPICS", "BRICK", "CERTAINTY", "PICTURE", "SETTINGS"):
                require(robot_name(m["robot"]) == node, node, "wrong sender")
                self._hear_piece(m, data)
            elif kind == "EDIT":  # whoever made it, any node may say it
                self._hear_edit(data)
            elif kind != "REQUEST":
                self._lists.setdefault((node, kind), _Lists()).hear(m, data)
            self.heard += 1
        except BadMessage as error:
            self.refused[error.reason] += 1

    def _hear_edit(self, data):
        m = decode(data)
        require(len(self._edits) < 10000, "edits", "over limit")
        self._edits.setdefault(edit_hash(m), m)

    def _hear_piece(self, m, data):
        content = _content(data)
        self._times[content] += 1
        if self._times[content] > 1:
            self.refused.update(self._bad.get(content, ()))
            return
        for place, (index, version, _) in enumerate(keys_of(data)):
            versions = self._versions.setdefault((m["robot"], m["kind"], index), {})
            versions.setdefault(version, []).append((data, place))
        self._usable = None
        self._digests = {}

    def _epochs(self):
        """{robot: its newest epoch of which any good part or a heartbeat has come}."""
        said = collections.defaultdict(lambda: collections.defaultdict(list))  # robot -> epoch -> what it said in it
        for (robot, *_), versions in self._versions.items():
            for (epoch, _), raw in versions.items():
                said[robot][epoch].append(raw)
        newest = {}
        for robot, epochs in said.items():
            candidates = sorted(epochs, reverse=True)
            newest[robot] = next((epoch for epoch in candidates[:-1] if any([self._parts(raw) for raw in epochs[epoch]])),
                                 candidates[-1])
            if (said_last := self.heartbeats.get(robot_name(robot))) is not None:
                newest[robot] = max(newest[robot], said_last["epoch"])
        return newest

    def pieces(self):
        """The state: for every topic and brick the parts of the newest version whose part 0 has come, ascending.
        Of each robot one epoch counts, the newest.

        [(robot, kind, index, {part: decoded message})]
        """
        if self._usable is None:
            self._usable = []
            epochs = self._epochs()
            for (robot, kind, index), versions in sorted(self._versions.items(), key=lambda item: item[0]):
                for version in sorted((v for v in versions if v[0] == epochs[robot]), reverse=True):
                    parts = self._parts(versions[version])
                    if 0 in parts:
                        self._usable.append((robot, kind, index, dict(sorted(parts.items()))))
                        break
        return self._usable

    def _parts(self, raw):
        """The parts of one version, decoded; what is bad among `raw` is counted and forgotten."""
        parts, good = {}, []
        for data, place in raw:
            pieces = self._decode(data)
            if pieces is None:
                continue
            m = pieces[place]
            alike = all(m["num_parts"] == other["num_parts"] for other in parts.values())
            if alike and parts.get(m["part"], m) == m:  # heard again, perhaps in other company
                parts[m["part"]] = m
                good.append((data, place))
            else:
                self._refuse(data, "conflict")
        raw[:] = good
        return parts

    def _decode(self, data):
        """The pieces of a message, decoded once; None when it is bad."""
        if data not in self._decoded:
            try:
                self._decoded[data] = pieces_of(decode(data))
            except BadMessage as error:
                self._refuse(data, error.reason)
                self._decoded[data] = None
        return self._decoded[data]

    def _refuse(self, data, reason):
        """Counts a message that turns out bad as often as it was heard, and will be."""
        content = _content(data)
        self._bad.setdefault(content, collections.Counter())[reason] += 1
        self.refused[reason] += self._times[content]

    @property
    def cell_size_m(self):
        """Edge of a cell as the first robot by name says it, metres; 1 before any did."""
        said = [h["cell_size_m"] for _, h in sorted(self.heartbeats.items()) if h["phase"] != "node"]
        return said[0] if said else 1.0

    def robots(self):
        """Names of the robots of which something is known."""
        return sorted({robot_name(robot) for robot, *_ in self.pieces()}, key=lambda name: int(name[1:]))

    def _of(self, robot, kind):
        return [parts for number, k, _, parts in self.pieces() if k == kind and robot_name(number) == robot]

    def cells(self, robot):
        """A robot's own map: {(x, y, z): (topic, seen_us, certainty steps)}; 0 steps where none was heard."""
        steps = {cell: level for parts in self._of(robot, "CERTAINTY") for m in parts.values()
                 for cell, level, _ in m["certainties"]}
        cells = {}
        for parts in self._of(robot, "BRICK"):
            for m in parts.values():
                for cell, topic, seen_us in m["cells"]:
                    if cell not in cells or cells[cell][1] < seen_us:
                        cells[cell] = (topic, seen_us, steps.get(cell, 0))
        return cells

    def surprises(self, robot):
        """{(x, y, z): how unusual the cell was to the robot when it saw it, 1 being what one in ten exceeds}."""
        return {cell: steps / 8 for parts in self._of(robot, "CERTAINTY") for m in parts.values()
                for cell, _, steps in m["certainties"] if steps}

    def topics(self, robot):
        """{id: {"created_us", "weight", "group_sizes", "words": {word: count}}}, retired topics left out."""
        topics = {}
        for parts in self._of(robot, "TOPICS"):
            first = parts[0]
            if first["weight"] == 0:
                continue
            words = {}
            for m in parts.values():
                if m["group_sizes"] == first["group_sizes"]:
                    for word, count in m["words"]:
                        words[word] = min(count, words.get(word, count))
            topics[first["topic"]] = {"created_us": first["created_us"], "weight": first["weight"],
                                      "group_sizes": first["group_sizes"], "words": dict(sorted(words.items()))}
        return dict(sorted(topics.items()))

    def digest(self, robot):
        """The digest of what is held of a robot; equal to own_digest of its heartbeat when that is all it has."""
        if not self._digests:
            for number, _, _, parts in self.pieces():
                own = sum(content_hash(m) for m in parts.values())
                self._digests[robot_name(number)] = self._digests.get(robot_name(number), 0) + own & MASK
        return self._digests.get(robot, 0)

    def state_digest(self):
        """The digest of all that is held."""
        digest = 0
        for robot in self.robots():
            own = self.digest(robot)
            if own:
                digest = hash_of((int(robot[1:]), own), digest)
        decided = sum(content_hash(m) for m in self._edits.values()) & MASK
        return hash_of((OPERATORS, decided), digest) if decided else digest

    def edits(self):
        """What operators decided, as decoded messages of kind EDIT, in the order in which it counts."""
        return sorted(self._edits.values(), key=lambda m: (m["made_us"], m["author"], m["counter"], edit_hash(m)))

    def excluded(self):
        """Names of the robots that do not count."""
        undone, excluded = set(), set()
        for m in reversed(self.edits()):
            if (m["author"], m["counter"]) in undone:
                continue
            if m["operation"] == "undo":
                undone.add(tuple(m["undone"]))
            elif m["operation"] == "exclude":
                excluded.add(robot_name(m["robot"]))
        return sorted(excluded)

    def _of_other_cells(self):
        """Names of the robots whose cells are of another size than most robots'."""
        said = {robot: (m["words"], m["hyperparameters"], m["cell_size_m"])
                for robot, kind, _, parts in self.pieces() if kind == "SETTINGS" for m in parts.values()}
        counted = [settings for robot, settings in sorted(said.items()) if robot_name(robot) not in self.excluded()]
        if not counted:
            return []
        common = max(counted, key=counted.count)  # the first among equals
        return [robot_name(robot) for robot, settings in said.items() if settings[2] != common[2]]

    def nodes_with_maps(self):
        return sorted({node for node, _ in self._lists})

    def map(self, node=None):
        """The newest fused map that a node published; None when there is none.

        node: which one's; OPERATOR's, else the first by name, when not told.
        Returns {"node", "digest", "source", "cells": {(x, y, z): (label, robot, seen_us, steps)},
        "correspondences": [(robot, topic, label)], "labels": [row]}. `source` is "MAP" when the node published the
        cells, "MATCHES" when they are put together here from the robots' maps and the node's correspondences,
        "MATCHES of another state" when these do not add up to the node's digest.
        """
        if node is None:
            nodes = self.nodes_with_maps()
            node = "OPERATOR" if "OPERATOR" in nodes else nodes[0] if nodes else None
        matches, drawn, named = (self._lists.get((node, kind), _Lists()) for kind in ("MATCHES", "MAP", "LABELS"))
        digest = matches.newest() if matches.newest() is not None else drawn.newest()
        if digest is None:
            return None
        pairs = [pair for m in matches.whole(digest) or [] for pair in m["correspondences"]]
        chunks = drawn.whole(digest)
        if chunks:
            cells, source = {c[0]: c[1:] for m in chunks for c in m["fused_cells"]}, "MAP"
        else:
            cells = self._fuse(pairs)
            source = "MATCHES" if map_digest(cells, pairs) == digest else "MATCHES of another state"
        return {"node": node, "digest": digest, "source": source, "cells": cells, "correspondences": pairs,
                "labels": [row for m in named.whole(digest) or [] for row in m["labels"]]}

    def _fuse(self, correspondences):
        """A cell shows what the robot that saw it last says; of two at the same time, the higher number."""
        label_of = {(robot, topic): label for robot, topic, label in correspondences}
        cells = {}
        for name in set(self.robots()) - set(self.excluded()) - set(self._of_other_cells()):
            robot = int(name[1:])
            for cell, (topic, seen_us, steps) in self.cells(name).items():
                if cell not in cells or (cells[cell][2], cells[cell][1]) < (seen_us, robot):
                    cells[cell] = (label_of.get((robot, topic), robot * 10000 + topic), robot, seen_us, steps)
        return cells


def read_log(path, mission=None, key=None):
    """The Mission that an LCM log holds: `mission`, else that of its first heartbeat. BadFile when there is none.

    key: of the team, read_key(FILE): what it did not seal is left out. Without it seals are not checked.
    """
    log = Log(path)
    if mission is None:
        for _, channel, data in log:
            try:
                kind, _, said = peek(unsealed(channel, data, key))
            except BadMessage:
                continue
            if kind == "HEARTBEAT":
                mission = said
                break
        if mission is None:
            raise BadFile(f"{path} holds no heartbeat of a mission; is it an LCM log?")
    state = Mission(mission, key)
    for _, channel, data in log:
        state.hear(channel, data)
    if log.damaged:
        state.refused["damaged log"] += log.damaged
    return state
