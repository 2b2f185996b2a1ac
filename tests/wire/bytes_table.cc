// SPDX-License-Identifier: BSD-3-Clause
// shoal_wire_bytes [WORLD[@IMAGES]...]: what maps and topics take on the wire beside what general coders make
// of them, as the tables of docs/benchmarks.md. Twelve robots fly over each world in this process, 60 images
// each unless said. With cjxl (libjxl-tools) and draco_encoder (draco) in the PATH, lossless JPEG XL and
// Draco too.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "flight.h"
#include "label_field.h"
#include "other_coders.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/random.h"
#include "shoal/wire/piece_codec.h"
#include "state_cost.h"

namespace {

using namespace shoal;  // NOLINT: a main file
namespace fs = std::filesystem;

using wire::Cost;

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

Cost costOfBricks(const std::vector<mapping::BrickCell>& cells) { return wire::costOf(piecesOf(cells)); }

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

// A mission flown.
struct Mission {
  std::string name;
  wire::Team team;
};

Mission fly(const std::string& what) {
  const size_t at = what.find('@');
  const std::string world = what.substr(0, at);
  int32_t images = 60;
  if (at != std::string::npos) {
    const char* const end = what.data() + what.size();
    const auto read = std::from_chars(what.data() + at + 1, end, images);
    if (read.ec != std::errc{} || read.ptr != end || images < 1)
      throw std::invalid_argument(what + ": images after @ are a number from 1 on");
  }
  const std::string name = fs::path(world).filename().string();
  return {images == 60 ? name : name + ", " + std::to_string(images) + " images",
          wire::learn(wire::look(world, images), 1, wire::usualKnobs())};
}

NamedMap fusedMapOf(const Mission& mission) {
  NamedMap map{mission.name, {}};
  std::map<world::GlobalLabel, int32_t> numbers;
  for (const auto& c : wire::fused(mission.team).cells) {
    const auto next = static_cast<int32_t>(numbers.size());
    map.cells.push_back({c.cell, world::TopicId{numbers.emplace(c.label, next).first->second}, {}});
  }
  if (numbers.size() > 255) throw std::runtime_error(mission.name + ": more than 255 labels");
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

// Topics of one robot as whole pieces with their exact counts.
std::vector<mapping::Piece> exactTopics(const mapping::LocalBelief& belief) {
  std::vector<int32_t> sizes;
  for (const auto& group : belief.groups) sizes.push_back(group.size);
  std::vector<mapping::Piece> pieces;
  for (const auto& topic : belief.topics) {
    const mapping::PieceKey key{belief.robot, mapping::PieceKind::kTopic, {number(topic.id), 0, 0}};
    pieces.push_back(
        {key, {0, 59}, 0, 1, mapping::TopicPart{topic.created, topic.weight, sizes, topic.words}});
  }
  return pieces;
}

size_t float32BytesOf(const mapping::LocalBelief& belief) {
  size_t words = 0;
  for (const auto& group : belief.groups) words += static_cast<size_t>(group.size);
  return 4 * words * belief.topics.size();
}

double adaptiveEntropyOf(const mapping::LocalBelief& belief) {
  double bytes = 0;
  for (const auto& group : belief.groups) {
    AdaptiveEntropy entropy;
    for (const auto& topic : belief.topics) {
      std::map<int32_t, int32_t> counts;
      for (const auto& [word, count] : topic.words) counts[word] = count;
      for (int32_t word = group.first; word < group.first + group.size; ++word)
        entropy.add(counts.contains(word) ? counts.at(word) : 0);
    }
    bytes += entropy.bytes();
  }
  return bytes;
}

// The greatest 1 - cosine of coarse topics to the exact counts.
double worstCosineOf(mapping::LocalBelief belief) {
  belief.detail = mapping::Detail::kCoarse;
  const std::vector<mapping::Piece> pieces = mapping::wholePieces(belief);
  double worst = 0;
  for (size_t i = 0; i < belief.topics.size(); ++i) {  // topics come first
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
  }
  return worst;
}

void printTopics(const Mission& mission) {
  Cost cost;
  double ideal = 0;
  size_t topics = 0, non_zero = 0, float32 = 0;
  for (const mapping::LocalBelief& belief : mission.team) {
    const Cost own = wire::costOf(exactTopics(belief));
    cost.payload += own.payload;
    cost.datagrams += own.datagrams;
    ideal += adaptiveEntropyOf(belief);
    float32 += float32BytesOf(belief);
    topics += belief.topics.size();
    for (const auto& topic : belief.topics) non_zero += topic.words.size();
  }
  std::printf("| %s | %zu | %zu | %zu | %.0f | %zu (%.2f) | %zu |\n", mission.name.c_str(), topics, non_zero,
              float32, ideal, cost.payload, static_cast<double>(cost.payload) / ideal, cost.datagrams);
}

// All that a robot would have to tell somebody who knows nothing, of all robots the mean and the most:
// datagrams with fixed fields, channel and LCM's header.
void printState(const Mission& mission, mapping::Detail detail) {
  size_t topics = 0, labels = 0, certainties = 0, robots = 0, most = 0;
  for (mapping::LocalBelief belief : mission.team) {
    belief.detail = detail;
    const wire::StateCost own = wire::costOfState(belief);
    topics += own.topics.datagrams;
    labels += own.labels.datagrams;
    certainties += own.certainties.datagrams;
    most = std::max(most, own.datagrams());
    ++robots;
  }
  std::printf("| %s | %s | %zu | %zu | %zu | %zu | %zu |\n", mission.name.c_str(),
              std::string(mapping::toText(detail)).c_str(), topics / robots, labels / robots,
              certainties / robots, (topics + labels + certainties) / robots, most);
}

// What coarse topics of all robots take, and how far they are from the exact counts.
void printCoarse(const Mission& mission) {
  Cost cost;
  size_t float32 = 0;
  double worst = 0;
  for (mapping::LocalBelief belief : mission.team) {
    float32 += float32BytesOf(belief);
    worst = std::max(worst, worstCosineOf(belief));
    belief.detail = mapping::Detail::kCoarse;
    const Cost own = wire::costOfState(belief).topics;
    cost.payload += own.payload;
    cost.datagrams += own.datagrams;
  }
  std::printf("| %s | %zu | %zu (1/%.0f) | %zu | %.4f |\n", mission.name.c_str(), float32, cost.payload,
              static_cast<double>(float32) / static_cast<double>(cost.payload), cost.datagrams, worst);
}

// CPU milliseconds to encode all bricks once it is known how many fit into each message, and to decode (and
// check) them.
void printTimes(const NamedMap& map) {
  const auto milliseconds = [](std::clock_t since) {
    return 1e3 * static_cast<double>(std::clock() - since) / CLOCKS_PER_SEC;
  };
  const std::vector<mapping::Piece> pieces = piecesOf(map.cells);
  std::vector<size_t> bricks;  // of each message
  std::vector<wire::Bytes> messages = wire::messagesOf(pieces);
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

void printMissions(const std::vector<Mission>& missions) {
  std::puts("\n| mission | topics | counts > 0 | float32 | adaptive entropy | ours, payloads | ours, all |");
  std::puts("|---|---|---|---|---|---|---|");
  for (const Mission& mission : missions) printTopics(mission);
  std::puts("\n| mission | float32 | coarse topics, payloads | all | greatest 1 - cosine |");
  std::puts("|---|---|---|---|---|");
  for (const Mission& mission : missions) printCoarse(mission);
  std::puts("\n| mission | detail | topics | labels and times | certainties | all, mean | most |");
  std::puts("|---|---|---|---|---|---|---|");
  for (const Mission& mission : missions)
    for (const auto detail : {mapping::Detail::kFine, mapping::Detail::kCoarse}) printState(mission, detail);
}

void run(std::span<char*> worlds) {
  const std::vector<NamedMap> fields{synthetic(0), synthetic(0.03)};
  std::vector<Mission> missions;
  for (const char* world : worlds) missions.push_back(fly(world));
  std::vector<NamedMap> maps;
  for (const Mission& mission : missions) maps.push_back(fusedMapOf(mission));
  std::puts("\n| map | cells | zstd -19 | JPEG XL | ours, payloads | datagrams | ours, all |");
  std::puts("|---|---|---|---|---|---|---|");
  for (const NamedMap& map : fields) printLabels(map);
  for (const NamedMap& map : maps) printLabels(map);
  std::puts(
      "\n| solid map | cells | Draco | OctoMap .ot | ours, payloads | ours, all (of Draco, of OctoMap) |");
  std::puts("|---|---|---|---|---|---|");
  printSolid(legs());
  for (const NamedMap& map : maps) printSolid(map);
  if (!missions.empty()) printMissions(missions);
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
