// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/held_pictures.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <tuple>

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;
using Topic = std::pair<world::RobotId, world::TopicId>;

std::string hex(const std::vector<uint8_t>& bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::vector<uint8_t> bytesOf(const std::string& hex) {
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i + 1 < hex.size(); i += 2) {
    uint8_t byte = 0;
    const auto [end, error] = std::from_chars(hex.data() + i, hex.data() + i + 2, byte, 16);
    if (error != std::errc{} || end != hex.data() + i + 2) {
      throw std::runtime_error("a layer of a picture is not in hexadecimal digits");
    }
    bytes.push_back(byte);
  }
  return bytes;
}

std::map<Topic, int64_t> weightsOf(const BeliefStore& beliefs) {
  std::map<Topic, int64_t> weights;
  beliefs.visit([&](const Piece& piece) {
    if (const auto* topic = std::get_if<TopicPart>(&piece.content)) {
      weights[{piece.key.robot, world::TopicId{piece.key.index[0]}}] = topic->weight;
    }
  });
  return weights;
}

}  // namespace

std::vector<HeldPicture> heldPictures(const BeliefStore& beliefs) {
  std::vector<HeldPicture> pictures;
  std::map<PieceKey, size_t> place;  // among them
  beliefs.visit([&](const Piece& piece) {
    const auto* part = std::get_if<PicturePart>(&piece.content);
    if (part == nullptr || part->layer.empty() || piece.key.index[1] >= kSharperBy) return;
    if (piece.part == 0) {
      place.emplace(piece.key, pictures.size());
      pictures.push_back({.robot = piece.key.robot,
                          .topic = world::TopicId{piece.key.index[0]},
                          .number = piece.key.index[1],
                          .cell = part->cell,
                          .seen = part->seen,
                          .num_layers = piece.num_parts,
                          .layers = {}});
    }
    HeldPicture& picture = pictures.back();  // part 0 of a piece that is held comes first
    if (piece.part == static_cast<int32_t>(picture.layers.size())) picture.layers.push_back(part->layer);
  });
  for (const auto& [key, i] : place) {
    const Piece* shown = beliefs.find(key, 0);
    std::vector<std::vector<uint8_t>> layers;
    int32_t num_layers = 1;
    beliefs.visitOf(PieceKey{key.robot, key.kind, {key.index[0], key.index[1] + kSharperBy, 0}},
                    [&](const Piece& piece) {
                      const auto* part = std::get_if<PicturePart>(&piece.content);
                      if (part == nullptr || part->layer.empty() || piece.version != shown->version) return;
                      num_layers = piece.num_parts;
                      if (piece.part == static_cast<int32_t>(layers.size())) layers.push_back(part->layer);
                    });
    if (std::ssize(layers) != num_layers) continue;
    pictures[i].num_layers = num_layers;
    pictures[i].layers = std::move(layers);
    pictures[i].sharpened = true;
  }
  return pictures;
}

std::map<world::GlobalLabel, std::vector<HeldPicture>> picturesOfLabels(const GlobalMap& map,
                                                                        const BeliefStore& beliefs,
                                                                        size_t most) {
  std::map<Topic, world::GlobalLabel> label_of;
  for (const Correspondence& c : map.correspondences) label_of[{c.robot, c.topic}] = c.label;
  const std::map<Topic, int64_t> weights = weightsOf(beliefs);
  std::map<world::GlobalLabel, std::vector<HeldPicture>> pictures;
  for (HeldPicture& picture : heldPictures(beliefs)) {
    const auto label = label_of.find({picture.robot, picture.topic});
    if (label != label_of.end()) pictures[label->second].push_back(std::move(picture));
  }
  for (auto& [label, held] : pictures) {
    const auto rank = [&, oldest = label](const HeldPicture& p) {
      const auto weight = weights.find({p.robot, p.topic});
      return std::tuple(world::globalLabel(p.robot, p.topic) != oldest, p.number,
                        weight == weights.end() ? 0 : -weight->second, p.robot, p.topic);
    };
    std::ranges::stable_sort(held, {}, rank);
    if (held.size() > most) held.resize(most);
  }
  return pictures;
}

Json toJson(const HeldPicture& p) {
  Json layers = Json::array();
  for (const auto& layer : p.layers) layers.push_back(hex(layer));
  Json json{{"robot", name(p.robot)},     {"topic", number(p.topic)},
            {"example", p.number},        {"cell", {p.cell.x, p.cell.y, p.cell.z}},
            {"seen_s", p.seen.seconds()}, {"num_layers", p.num_layers},
            {"layers", std::move(layers)}};
  if (p.sharpened) json["sharpened"] = true;
  return json;
}

Json picturesAnswer(const LabelPictures& of_labels) {
  Json labels = Json::array();
  for (const auto& [label, pictures] : of_labels) {
    Json row{{"label", number(label)}, {"pictures", Json::array()}};
    for (const HeldPicture& p : pictures) row["pictures"].push_back(toJson(p));
    labels.push_back(std::move(row));
  }
  return {{"labels", std::move(labels)}};
}

LabelPictures picturesFrom(const Json& answer) {
  LabelPictures pictures;
  try {
    for (const Json& row : answer.at("labels")) {
      std::vector<HeldPicture>& of_label = pictures[world::GlobalLabel{row.at("label").get<int32_t>()}];
      for (const Json& p : row.at("pictures")) {
        const auto robot = world::parseRobotId(p.at("robot").get<std::string>());
        if (!robot) throw std::runtime_error("a picture is of no robot");
        HeldPicture held{.robot = *robot,
                         .topic = world::TopicId{p.at("topic").get<int32_t>()},
                         .number = p.at("example"),
                         .cell = {p.at("cell").at(0), p.at("cell").at(1), p.at("cell").at(2)},
                         .seen = {std::llround(p.at("seen_s").get<double>() * 1e6)},
                         .num_layers = p.at("num_layers"),
                         .layers = {},
                         .sharpened = p.value("sharpened", false)};
        for (const Json& layer : p.at("layers")) held.layers.push_back(bytesOf(layer.get<std::string>()));
        if (held.layers.empty()) throw std::runtime_error("a picture has no layer");
        of_label.push_back(std::move(held));
      }
    }
  } catch (const Json::exception& error) {
    throw std::runtime_error(std::string("pictures: ") + error.what());
  }
  return pictures;
}

}  // namespace shoal::mapping
