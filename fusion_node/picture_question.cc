// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/picture_question.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "fusion_node/repair.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/packet.h"
#include "shoal/comms/sender.h"
#include "shoal/mapping/area_answer.h"
#include "shoal/wire/picture_pieces.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"

namespace shoal::fusion_node {
namespace {

using Json = nlohmann::ordered_json;

std::string topicName(const mapping::HeldPicture& p) {
  return name(p.robot) + " example " + std::to_string(number(p.topic));
}

std::vector<mapping::HeldPicture> picturesOf(const MissionState& state, const Json& question) {
  std::vector<mapping::HeldPicture> held = mapping::heldPictures(state.beliefs());
  if (held.empty())
    throw std::invalid_argument("no picture has come yet; a sharper one is asked for after it");
  if (question.contains("label")) {
    const std::string text = question.at("label");
    const auto label = mapping::labelNamed(state.map(), text);
    if (!label) throw std::invalid_argument(mapping::noSuchLabel(state.map(), text));
    auto of_labels = mapping::picturesOfLabels(state.map(), state.beliefs());
    if (!of_labels.contains(*label)) {
      throw std::invalid_argument("of label " + text + " no picture has come yet; ask again later");
    }
    return of_labels.at(*label);
  }
  const std::string robot = question.at("robot");
  const int32_t topic = question.at("topic");
  std::string known;
  std::vector<mapping::HeldPicture> chosen;
  for (mapping::HeldPicture& p : held) {
    if (p.number == 0 && name(p.robot) == robot) known += " " + std::to_string(number(p.topic));
    if (name(p.robot) == robot && number(p.topic) == topic) chosen.push_back(std::move(p));
  }
  if (!chosen.empty()) return chosen;
  throw std::invalid_argument("no picture of topic " + std::to_string(topic) + " of " + robot + " is held; " +
                              (known.empty() ? "none of that robot is" : "held are those of topics" + known));
}

size_t requestBytes(const SharperPicture& wanted, const std::string& node) {
  comms::Statement statement{comms::Statement::Kind::kWanted, number(wanted.key.robot), false, {}, {}, {}};
  for (const int32_t part : {0, 1}) {
    statement.leaves.push_back({nameOf(wanted.key, part).second, versionOf(wanted.version)});
  }
  std::ranges::sort(statement.leaves, {}, &comms::Statement::Named::key);
  const auto message = wire::encodeRequest(comms::encodeTalk({0, {statement}}), 0, {});
  return comms::wireSize(comms::channelName(node, "REQUEST").size(), message.size());
}

size_t answerBytes(const SharperPicture& wanted) {
  mapping::Piece piece{.key = wanted.key,
                       .version = wanted.version,
                       .part = 0,
                       .num_parts = 2,
                       .content = mapping::PicturePart{wanted.picture.cell, wanted.picture.seen, {}}};
  const size_t channel = comms::channelName(name(wanted.key.robot), "PICTURE").size();
  size_t bytes = 0;
  for (const size_t most : {wire::kSharperSizes.first, wire::kSharperSizes.second}) {
    std::get<mapping::PicturePart>(piece.content).layer.assign(most, 0);
    bytes += comms::wireSize(channel, wire::encode(piece, 0, {}).size());
  }
  return bytes;
}

bool isSharp(const mapping::HeldPicture& picture) {
  return picture.sharpened || wire::isFinest(picture.layers);
}

double secondsOf(double bytes, int64_t budget) {
  return budget == 0 ? 0 : bytes / comms::contentPerSecond(budget);
}

// Nobody knows how much a robot will yet say before it answers: pictures that are new by then stand before
// the one that is asked for, and all that is new shares the budget by weight.
bool hasMoreToTell(const wire::Heartbeat& robot) {
  return robot.phase == wire::Phase::kFlying || robot.phase == wire::Phase::kListening;
}

}  // namespace

SharperPicture sharperPicture(const MissionState& state, const Json& question) {
  const std::vector<mapping::HeldPicture> held = picturesOf(state, question);
  const int32_t example = question.value("example", held.front().number);
  const auto found = std::ranges::find(held, example, &mapping::HeldPicture::number);
  if (found == held.end()) {
    throw std::invalid_argument(topicName(held.front()) + " has no picture number " +
                                std::to_string(example) + "; it has " + std::to_string(held.size()) +
                                ", from 0 on");
  }
  SharperPicture wanted{
      *found, {found->robot, mapping::PieceKind::kPicture, {number(found->topic), example, 0}}, {}};
  wanted.version = state.beliefs().find(wanted.key, 0)->version;
  wanted.key.index[1] += mapping::kSharperBy;
  return wanted;
}

Json priceOf(const MissionState& state, const SharperPicture& wanted, const std::string& node,
             int64_t budget) {
  const mapping::HeldPicture& p = wanted.picture;
  const bool is_sharp = isSharp(p);
  Json answer{
      {"robot", name(p.robot)}, {"topic", number(p.topic)}, {"example", p.number}, {"label", nullptr}};
  for (const mapping::Correspondence& c : state.map().correspondences)
    if (c.robot == p.robot && c.topic == p.topic) answer["label"] = number(c.label);
  answer["state"] = is_sharp ? "sharp" : "not sharp";
  const size_t request = is_sharp ? 0 : requestBytes(wanted, node);
  const size_t reply = is_sharp ? 0 : answerBytes(wanted);
  answer["bytes"] = {{"request", request}, {"answer", reply}};
  answer["seconds"] = nullptr;
  answer["heard_ago_s"] = nullptr;
  const auto said = state.heartbeats().find(name(p.robot));
  if (said != state.heartbeats().end()) {
    const wire::Heartbeat& robot = said->second;
    if (is_sharp) {
      answer["seconds"] = 0;
    } else if (!hasMoreToTell(robot)) {
      const double waits = static_cast<double>(robot.queue_bytes) + static_cast<double>(reply);
      const double seconds = secondsOf(static_cast<double>(request), budget) + secondsOf(waits, robot.budget);
      answer["seconds"] = std::ceil(seconds * 10) / 10;
    }
    answer["heard_ago_s"] = std::max(0.0, state.latestTime().seconds() - robot.time.seconds());
  }
  answer["picture"] = mapping::toJson(p);
  return answer;
}

}  // namespace shoal::fusion_node
