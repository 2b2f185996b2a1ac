// SPDX-License-Identifier: BSD-3-Clause
// shoal_wire_bytes [RUN...]: what maps and topics take on the wire beside what general coders make of them,
// as the tables of docs/benchmarks.md. A RUN is the folder of a finished mission. With cjxl (libjxl-tools)
// and draco_encoder (draco) in the PATH, lossless JPEG XL and Draco too.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "label_field.h"
#include "other_coders.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/belief_files.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/map_files.h"
#include "shoal/random.h"
#include "shoal/wire/cut.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/piece_codec.h"

namespace {

using namespace shoal;  // NOLINT: a main file
namespace fs = std::filesystem;

// What a channel like SHOAL_R00_BRICK adds to a message in a datagram: LCM's header, the name, its NUL.
constexpr size_t kAround = 8 + 15 + 1;
constexpr size_t kFixedTopics = 45, kFixedBricks = 35;

struct Cost {
  size_t payload = 0;    // bytes of payloads
  size_t datagrams = 0;  // with fixed fields, channel and LCM's header
  size_t count = 0;
};

void add(Cost& cost, size_t message, size_t fixed) {
  cost.payload += message - fixed;
  cost.datagrams += message + kAround;
  ++cost.count;
}

std::map<std::array<int32_t, 3>, mapping::BrickPart> bricksOf(const std::vector<mapping::BrickCell>& cells) {
  std::map<std::array<int32_t, 3>, mapping::BrickPart> bricks;
  for (const auto& c : cells) bricks[mapping::brickOf(c.cell)].cells.push_back(c);  // ascending as cells are
  return bricks;
}

std::vector<mapping::Piece> piecesOf(const std::vector<mapping::BrickCell>& cells) {
  std::vector<mapping::Piece> pieces;
  for (const auto& [index, brick] : bricksOf(cells))
    pieces.push_back({{world::RobotId{0}, mapping::PieceKind::kBrick, index}, {0, 59}, 0, 1, brick});
  return pieces;
}

// As many bricks a message as fit.
std::vector<wire::Bytes> messagesOf(const std::vector<mapping::Piece>& pieces) {
  const auto fits = [&](size_t begin, size_t end) {
    try {
      return wire::encode(std::span(pieces).subspan(begin, end - begin), 1, {}).size() <=
             wire::maxPayload(16);
    } catch (const std::invalid_argument&) {
      return false;  // too long, or too many cells
    }
  };
  std::vector<wire::Bytes> messages;
  for (const auto& [begin, end] : wire::cutRuns(pieces.size(), wire::kMaxBricksPerMessage, fits))
    messages.push_back(wire::encode(std::span(pieces).subspan(begin, end - begin), 1, {}));
  return messages;
}

Cost costOfBricks(const std::vector<mapping::BrickCell>& cells) {
  Cost cost;
  for (const wire::Bytes& message : messagesOf(piecesOf(cells))) add(cost, message.size(), kFixedBricks);
  return cost;
}

// Ideal code length, bytes, of numbers whose distribution is learned on the way: a number seen c times among
// n so far, d of them distinct, costs -log2(c / (n + d)); a new one -log2(d / (n + d)) and Elias' gamma code
// of it.
class AdaptiveEntropy {
 public:
  void add(int64_t value) {
    int64_t& seen = seen_[value];
    const auto total = static_cast<double>(n_ + std::max<int64_t>(distinct_, 1));
    bits_ -= std::log2(static_cast<double>(seen > 0 ? seen : std::max<int64_t>(distinct_, 1)) / total);
    if (seen == 0) {
      ++distinct_;
      bits_ += 2 * std::floor(std::log2(static_cast<double>(value + 1))) + 1;
    }
    ++seen;
    ++n_;
  }
  double bytes() const { return bits_ / 8; }

 private:
  std::map<int64_t, int64_t> seen_;
  int64_t n_ = 0, distinct_ = 0;
  double bits_ = 0;
};

struct NamedMap {
  std::string name;
  std::vector<mapping::BrickCell> cells;  // ascending; labels below 255 in place of topics
};

NamedMap synthetic(double speckle) {
  constexpr int kSide = 500;
  const auto field = wire::labelField(kSide, 10, speckle);
  NamedMap map{speckle > 0 ? "500 x 500, 10 labels, 3 % speckle" : "500 x 500, 10 labels, clean", {}};
  size_t unlike = 0;
  for (int x = 0; x < kSide; ++x) {
    for (int y = 0; y < kSide; ++y) {
      const int label = field[static_cast<size_t>(x * kSide + y)];
      map.cells.push_back({{x, y, 0}, world::TopicId{label}, {}});
      if (y > 0) unlike += label != field[static_cast<size_t>(x * kSide + y - 1)] ? 1 : 0;
    }
  }
  std::printf("%s: %.1f %% unlike neighbours\n", map.name.c_str(),
              100.0 * static_cast<double>(unlike) / (kSide * (kSide - 1)));
  return map;
}

double cellSizeOf(const std::string& run) {
  return nlohmann::json::parse(mapping::readFile(run + "/summary.json")).at("cell_size_m").get<double>();
}

NamedMap fusedMapOf(const std::string& run) {
  NamedMap map{fs::path(run).filename().string() + ", fused", {}};
  std::map<world::GlobalLabel, int32_t> numbers;
  for (const auto& c : mapping::readGlobalMap(run, world::Grid(cellSizeOf(run))).cells) {
    const auto next = static_cast<int32_t>(numbers.size());
    map.cells.push_back({c.cell, world::TopicId{numbers.emplace(c.label, next).first->second}, {}});
  }
  if (numbers.size() > 255) throw std::runtime_error(run + ": more than 255 labels");
  return map;
}

// The ground under four legs of 60 m, 4 m wide, in cells of 10 cm: waves and a slope, steps filled up so that
// it is closed, 1.5 % holes; labels as of synthetic(0.03).
NamedMap legs() {
  constexpr int kLength = 600, kWidth = 40, kLegs = 4;
  const auto field = wire::labelField(kLength, 10, 0.03);
  const auto height = [](int x, int y) {
    return static_cast<int>(std::lround(6 * std::sin(x * 0.021) + 4 * std::sin(y * 0.05 + x * 0.013) +
                                        1.5 * std::sin(x * 0.17) + 0.01 * x));
  };
  Random random(5);
  NamedMap map{"surface, 4 x 60 m x 4 m", {}};
  for (int x = 0; x < kLength; ++x) {
    for (int leg = 0; leg < kLegs; ++leg) {
      for (int y = leg * 140; y < leg * 140 + kWidth; ++y) {
        if (random.uniform() < 0.015) continue;
        const int top = height(x, y);
        const int below = std::min({top, height(x + 1, y) + 1, height(x, y + 1) + 1});
        for (int z = below; z <= top; ++z) {
          const int label = field[static_cast<size_t>(x * kLength + y)];
          map.cells.push_back({{x, y, z}, world::TopicId{label}, {}});
        }
      }
    }
  }
  return map;
}

void printSolid(const NamedMap& map) {
  const Cost cost = costOfBricks(map.cells);
  const size_t draco = wire::draco(map.cells), octomap = wire::octoMap(map.cells);
  const auto share = [&](size_t other) {
    return other == 0 ? 0.0 : static_cast<double>(cost.datagrams) / static_cast<double>(other);
  };
  std::printf("| %s | %zu | %zu | %zu | %zu | %zu (%.3f, %.4f) |\n", map.name.c_str(), map.cells.size(),
              draco, octomap, cost.payload, cost.datagrams, share(draco), share(octomap));
}

void printLabels(const NamedMap& map) {
  const Cost cost = costOfBricks(map.cells);
  const wire::Raster raster = wire::rasterOf(map.cells);
  const size_t zstd = wire::zstd19(raster.pixels), jxl = wire::jpegXl(raster);
  const auto ratio = [](size_t a, size_t b) { return static_cast<double>(a) / static_cast<double>(b); };
  std::printf("| %s | %zu | %zu | %zu | %zu (%.2f) | %zu | %zu (%.2f) |\n", map.name.c_str(),
              map.cells.size(), zstd, jxl, cost.payload, ratio(cost.payload, zstd), cost.count,
              cost.datagrams, ratio(cost.datagrams, zstd));
}

void printTopics(const std::string& run) {
  const world::Grid grid(cellSizeOf(run));
  Cost cost;
  double ideal = 0;
  size_t topics = 0, non_zero = 0, float32 = 0;
  for (const auto& folder : fs::directory_iterator(run + "/robots")) {
    const auto robot = world::parseRobotId(folder.path().filename().string());
    const mapping::LocalBelief belief = mapping::readBelief(folder.path(), robot.value(), grid);
    std::vector<AdaptiveEntropy> of_group(belief.groups.size());
    for (const auto& topic : belief.topics) {
      mapping::TopicPart part{topic.created, topic.weight, {}, topic.words};
      std::map<int32_t, int32_t> counts;
      for (const auto& [word, count] : topic.words) counts[word] = count;
      for (size_t g = 0; g < belief.groups.size(); ++g) {
        const auto& group = belief.groups[g];
        part.group_sizes.push_back(group.size);
        float32 += 4 * static_cast<size_t>(group.size);
        for (int32_t word = group.first; word < group.first + group.size; ++word)
          of_group[g].add(counts.contains(word) ? counts.at(word) : 0);
      }
      ++topics;
      non_zero += topic.words.size();
      const mapping::Piece whole{
          {*robot, mapping::PieceKind::kTopic, {number(topic.id), 0, 0}}, {0, 59}, 0, 1, std::move(part)};
      for (const mapping::Piece& each : wire::cutToFit(whole, wire::maxPayload(16)))
        add(cost, wire::encode(each, 1, {}).size(), kFixedTopics);
    }
    for (const auto& group : of_group) ideal += group.bytes();
  }
  std::printf("| %s | %zu | %zu | %zu | %.0f | %zu (%.2f) | %zu |\n",
              fs::path(run).filename().string().c_str(), topics, non_zero, float32, ideal, cost.payload,
              static_cast<double>(cost.payload) / ideal, cost.datagrams);
}

// All that a robot would have to tell somebody who knows nothing, of all robots the mean and the most:
// datagrams with fixed fields, channel and LCM's header.
void printState(const std::string& run, mapping::Detail detail) {
  const world::Grid grid(cellSizeOf(run));
  Cost topics, labels, certainties;
  size_t robots = 0, most = 0;
  for (const auto& folder : fs::directory_iterator(run + "/robots")) {
    const auto robot = world::parseRobotId(folder.path().filename().string());
    mapping::LocalBelief belief = mapping::readBelief(folder.path(), robot.value(), grid);
    belief.detail = detail;
    std::map<mapping::PieceKind, std::vector<mapping::Piece>> pieces;
    for (mapping::Piece& piece : mapping::wholePieces(belief))
      pieces[piece.key.kind].push_back(std::move(piece));
    Cost own;
    for (const mapping::Piece& whole : pieces[mapping::PieceKind::kTopic]) {
      for (const mapping::Piece& each : wire::cutToFit(whole, wire::maxPayload(16))) {
        const size_t size = wire::encode(each, 1, {}).size();
        add(topics, size, kFixedTopics);
        add(own, size, kFixedTopics);
      }
    }
    for (auto& [kind, cost] : {std::pair<mapping::PieceKind, Cost&>(mapping::PieceKind::kBrick, labels),
                               {mapping::PieceKind::kCertainty, certainties}}) {
      for (const wire::Bytes& message : messagesOf(pieces[kind])) {
        add(cost, message.size(), kFixedBricks);
        add(own, message.size(), kFixedBricks);
      }
    }
    ++robots;
    most = std::max(most, own.datagrams);
  }
  std::printf("| %s | %s | %zu | %zu | %zu | %zu | %zu |\n", fs::path(run).filename().string().c_str(),
              std::string(mapping::toText(detail)).c_str(), topics.datagrams / robots,
              labels.datagrams / robots, certainties.datagrams / robots,
              (topics.datagrams + labels.datagrams + certainties.datagrams) / robots, most);
}

// How far coarse topics are from the exact counts, and what they take: payloads of all robots' topics.
void printCoarse(const std::string& run) {
  const world::Grid grid(cellSizeOf(run));
  size_t float32 = 0;
  double worst = 0;
  Cost cost;
  for (const auto& folder : fs::directory_iterator(run + "/robots")) {
    const auto robot = world::parseRobotId(folder.path().filename().string());
    mapping::LocalBelief belief = mapping::readBelief(folder.path(), robot.value(), grid);
    belief.detail = mapping::Detail::kCoarse;
    const std::vector<mapping::Piece> pieces = mapping::wholePieces(belief);
    for (size_t i = 0; i < belief.topics.size(); ++i) {  // topics come first
      for (const auto& group : belief.groups) float32 += 4 * static_cast<size_t>(group.size);
      std::map<int32_t, double> exact;
      double squares = 0, coarse_squares = 0, product = 0;
      for (const auto& [word, count] : belief.topics[i].words) {
        exact[word] = count;
        squares += static_cast<double>(count) * count;
      }
      for (const auto& [word, level] : std::get<mapping::TopicPart>(pieces[i].content).words) {
        coarse_squares += static_cast<double>(level) * level;
        product += exact.at(word) * level;
      }
      worst = std::max(worst, 1 - product / std::sqrt(squares * coarse_squares));
      for (const mapping::Piece& each : wire::cutToFit(pieces[i], wire::maxPayload(16)))
        add(cost, wire::encode(each, 1, {}).size(), kFixedTopics);
    }
  }
  std::printf("| %s | %zu | %zu (1/%.0f) | %zu | %.4f |\n", fs::path(run).filename().string().c_str(),
              float32, cost.payload, static_cast<double>(float32) / static_cast<double>(cost.payload),
              cost.datagrams, worst);
}

// CPU milliseconds to encode all bricks once it is known how many fit into each message, and to decode (and
// check) them.
void printTimes(const NamedMap& map) {
  const auto milliseconds = [](std::clock_t since) {
    return 1e3 * static_cast<double>(std::clock() - since) / CLOCKS_PER_SEC;
  };
  const std::vector<mapping::Piece> pieces = piecesOf(map.cells);
  std::vector<size_t> bricks;  // of each message
  std::vector<wire::Bytes> messages = messagesOf(pieces);
  for (const wire::Bytes& bytes : messages)
    bricks.push_back(wire::decodePieces(wire::MessageKind::kBrick, bytes)->size());
  messages.clear();
  const std::clock_t encoding = std::clock();
  for (size_t i = 0, begin = 0; i < bricks.size(); begin += bricks[i++])
    messages.push_back(wire::encode(std::span(pieces).subspan(begin, bricks[i]), 1, {}));
  const double encode_ms = milliseconds(encoding);
  const std::clock_t decoding = std::clock();
  size_t cells = 0;
  for (const auto& bytes : messages) {
    const auto decoded = wire::decodePieces(wire::MessageKind::kBrick, bytes);
    for (const mapping::Piece& piece : *decoded)
      cells += std::get<mapping::BrickPart>(piece.content).cells.size();
  }
  std::printf("\n%zu cells (%s): encoded in %.0f ms, decoded in %.0f ms of CPU time\n", cells,
              map.name.c_str(), encode_ms, milliseconds(decoding));
}

void run(std::span<char*> runs) {
  const std::vector<NamedMap> fields{synthetic(0), synthetic(0.03)};
  std::puts("\n| map | cells | zstd -19 | JPEG XL | ours, payloads | datagrams | ours, all |");
  std::puts("|---|---|---|---|---|---|---|");
  for (const NamedMap& map : fields) printLabels(map);
  for (const char* folder : runs) printLabels(fusedMapOf(folder));
  std::puts(
      "\n| solid map | cells | Draco | OctoMap .ot | ours, payloads | ours, all (of Draco, of OctoMap) |");
  std::puts("|---|---|---|---|---|---|");
  printSolid(legs());
  for (const char* folder : runs) printSolid(fusedMapOf(folder));
  if (!runs.empty())
    std::puts(
        "\n| mission | topics | counts > 0 | float32 | adaptive entropy | ours, payloads | ours, all |");
  if (!runs.empty()) std::puts("|---|---|---|---|---|---|---|");
  for (const char* folder : runs) printTopics(folder);
  if (!runs.empty()) {
    std::puts("\n| mission | float32 | coarse topics, payloads | all | greatest 1 - cosine |");
    std::puts("|---|---|---|---|---|");
  }
  for (const char* folder : runs) printCoarse(folder);
  if (!runs.empty()) {
    std::puts("\n| mission | detail | topics | labels and times | certainties | all, mean | most |");
    std::puts("|---|---|---|---|---|---|---|");
  }
  for (const char* folder : runs)
    for (const auto detail : {mapping::Detail::kFine, mapping::Detail::kCoarse}) printState(folder, detail);
  printTimes(fields.back());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(std::span(argv + 1, static_cast<size_t>(argc - 1)));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "shoal_wire_bytes: %s\n", error.what());
    return 1;
  }
  return 0;
}
