// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shoal::comms {

/// Fades that come and go: a Gilbert-Elliott channel in continuous time. It is good for `good_s` and bad for
/// `bad_s` in the mean, each for an exponentially distributed time, so that a share bad_s / (good_s + bad_s)
/// of the time is bad. Source: E. N. Gilbert, "Capacity of a burst-noise channel", Bell Syst. Tech. J. 39,
/// 1960; E. O. Elliott, same journal 42, 1963.
struct Bursts {
  double good_s = 60;  ///< >= 0.001
  double bad_s = 0;    ///< >= 0; 0 = never bad
  double loss = 1;     ///< of what is sent in a bad time, in [0, 1]
};

/// From `from_s` to `until_s`, mission time of sending, only nodes of one group hear each other. Those that
/// no group names are one more group.
struct Partition {
  double from_s = 0;
  double until_s = 0;                                 ///< > from_s
  std::vector<std::vector<std::string>> groups = {};  ///< node names, each once
};

/// What a link does to messages on their way from one node to one other. Probabilities in [0, 1], seconds of
/// mission time. The default is a perfect link.
struct LinkModel {
  double rate_bytes_per_s = 0;  ///< what one sender gets through, all headers counted; 0 = no limit
  double queue_s = 60;          ///< what would wait longer than this for the rate is dropped by its sender
  double delay_s = 0;           ///< on the way
  double jitter_s = 0;          ///< up to so much more, uniform; does not change the order
  double loss = 0;              ///< independent of each other
  Bursts bursts;                ///< and besides, in fades
  double reordering = 0;        ///< share of messages that others overtake
  double duplication = 0;       ///< share of messages that come twice
  double late_s = 1;            ///< how much later, at most, what is overtaken or comes again comes; uniform
  double range_m = 0;           ///< nothing is heard from farther away; 0 = everywhere
  std::optional<std::array<double, 3>> base_m;  ///< where nodes are that do not fly; unset = in range
  std::vector<Partition> partitions;

  /// True when messages pass as if there were no model.
  bool isClean() const;
};

/// @throws std::invalid_argument naming the field that is out of range and what would be right.
void check(const LinkModel& model);

/// A link by name. What a source says is named; losses, fades and delays without one depend on the place and
/// are round numbers of ours. No preset has a range: reefs are 250 m wide.
///
///     clean      a perfect link
///     mesh       Wi-Fi without infrastructure, where multicast goes at the lowest basic rate and without
///                acknowledgement (RFC 9119, section 3): 1 Mbit/s of 802.11b, 5 ms + up to 20 ms, 5 % loss,
///                fades of .5 s every 20 s, 1 % overtaken, 1 % double
///     acoustic   WHOI Micro-Modem, PSK rate 5: about 5000 bit/s in packets of 3 s (L. Freitag et al., "The
///                WHOI Micro-Modem", OCEANS 2005; acomms.whoi.edu/micro-modem): 600 B/s, 1 s + up to 2 s,
///                10 % loss, fades of 6 s every minute
///     satellite  Iridium: 2400 bit/s; short-burst data take 5 s to 20 s (nalresearch.com/NetRef_SBD.html):
///                300 B/s, 5 s + up to 15 s, 1 % loss, 20 s without a satellite every 5 minutes
///
/// @returns nothing when no preset has that name.
std::optional<LinkModel> linkPreset(std::string_view name);

/// What `--link` names: a preset, or else a JSON file, as docs/link.md describes it.
/// @throws std::invalid_argument naming the file, the field and what would be right.
LinkModel readLink(const std::string& name_or_file);

/// The text of such a file; `origin` is named in errors.
LinkModel parseLink(const std::string& json, const std::string& origin);

}  // namespace shoal::comms
