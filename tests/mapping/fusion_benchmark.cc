// SPDX-License-Identifier: BSD-3-Clause
// Merging the maps of twelve robots, a million cells each: the newest wins, labels are translated. Windows of
// 1000 x 1000 cells lie at random in 2500 x 2500; "relief" is a height field in 3-D, in "rough" robots do not
// agree on heights, "flat" has one height. Times are a cell that goes in. Every structure runs in a process
// of its own, unless a filter is given: "cold" on fresh memory, "warm" in place: into what an earlier merge
// has left.
#include <benchmark/benchmark.h>

#include <malloc.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#ifdef SHOAL_HAS_OCTOMAP
#include <octomap/ColorOcTree.h>
#endif

#include "plain_fusion.h"
#include "shoal/mapping/fused_map.h"
#include "shoal/mapping/map_changes.h"
#include "shoal/mapping/told_surprises.h"
#include "shoal/random.h"

namespace {

using namespace shoal;           // NOLINT: a program of its own
using namespace shoal::mapping;  // NOLINT
using world::CellIndex;
using world::GlobalLabel;
using world::RobotId;
using world::TopicId;

constexpr int32_t kRobots = 12, kTopics = 20, kPlace = 2500, kWindow = 1000;

int32_t heightAt(int32_t x, int32_t y) {
  return static_cast<int32_t>(
      std::lround(8 * std::sin(x * 0.013) * std::cos(y * 0.011) + 3 * std::sin(x * 0.07 + y * 0.05)));
}

// "Rough": every robot errs by a cell in height in two cells of three.
enum class Scene { kFlat, kRelief, kRough };

int32_t heightIn(Scene scene, int32_t robot, int32_t x, int32_t y) {
  if (scene == Scene::kFlat) return 0;
  if (scene == Scene::kRelief) return heightAt(x, y);
  return heightAt(x, y) +
         static_cast<int32_t>(mix64(static_cast<uint64_t>((x * 4000 + y) * 16 + robot)) % 3) - 1;
}

// A robot's cells in the order of its lawnmower; topics in patches of 10 x 10, three in a hundred astray.
template <class Visit>
void eachCell(int32_t robot, Scene scene, int32_t window, Visit visit) {
  Random random(3, static_cast<uint64_t>(robot));
  const auto room = static_cast<uint64_t>(kPlace - kWindow);
  const auto x0 = static_cast<int32_t>(random.below(room)), y0 = static_cast<int32_t>(random.below(room));
  for (int32_t x = x0; x < x0 + window; ++x) {
    for (int32_t y = y0; y < y0 + window; ++y) {
      const uint64_t patch = random.uniform() < 0.03
                                 ? random()
                                 : mix64(static_cast<uint64_t>(x / 10 * 1000 + y / 10) + 7u * robot);
      const int64_t second = int64_t{x - x0} / 16 * 40 + (y - y0) / 25 + robot * 37;
      visit(CellIndex{x, y, heightIn(scene, robot, x, y)}, TopicId{static_cast<int32_t>(patch % kTopics)},
            world::Timestamp{second * 1'000'000});
    }
  }
}

// What the matching said: 25 labels in all.
GlobalLabel labelOf(int32_t robot, TopicId topic) {
  return GlobalLabel{(number(topic) * 7 + robot) % 25 * 10000 + 3};
}

struct Cell {
  CellIndex cell;
  int32_t robot;
  TopicId topic;
  world::Timestamp seen;
};

// In what order a robot's cells come: along its lawnmower, as an octree's leaves lie, or shuffled.
enum class Order { kLawnmower, kLeaves, kScattered };

uint64_t leafOrder(const CellIndex& cell) {
  uint64_t code = 0;
  for (int bit = 15; bit >= 0; --bit)
    for (const int32_t at : {cell.z, cell.y, cell.x})
      code = code << 1 | (static_cast<uint32_t>(at + 32768) >> bit & 1u);
  return code;
}

std::vector<Cell> cellsOfAll(Scene scene, Order order) {
  std::vector<Cell> cells;
  for (int32_t r = 0; r < kRobots; ++r) {
    const auto first = static_cast<std::ptrdiff_t>(cells.size());
    eachCell(r, scene, kWindow, [&](const CellIndex& c, TopicId topic, world::Timestamp seen) {
      cells.push_back({c, r, topic, seen});
    });
    const auto key = [&](const Cell& c) {
      return order == Order::kLeaves ? leafOrder(c.cell) : world::CellHash()(c.cell);
    };
    if (order == Order::kLawnmower) continue;
    std::vector<std::pair<uint64_t, size_t>> ranked;
    for (size_t i = static_cast<size_t>(first); i < cells.size(); ++i) ranked.emplace_back(key(cells[i]), i);
    std::ranges::sort(ranked);
    std::vector<Cell> sorted;
    for (const auto& [_, i] : ranked) sorted.push_back(cells[i]);
    std::ranges::copy(sorted, cells.begin() + first);
  }
  return cells;
}

void report(benchmark::State& state, double cells) {
  state.counters["ns_per_cell"] = benchmark::Counter(
      cells * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Runs `merge(structure)` on a new structure each time, or again and again on one that it has filled before.
template <class Structure, class Merge>
void run(benchmark::State& state, double cells, bool warm, Merge merge) {
  auto kept = std::make_unique<Structure>();
  if (warm) merge(*kept);
  for (auto _ : state) {
    merge(*kept);
    if (warm) continue;
    state.PauseTiming();
    kept = std::make_unique<Structure>();
    state.ResumeTiming();
  }
  report(state, cells);
}

struct Held {
  GlobalLabel label;
  int32_t robot;
  world::Timestamp seen;
};

template <Order order>
void UnorderedMap(benchmark::State& state, Scene scene, bool warm) {
  const std::vector<Cell> cells = cellsOfAll(scene, order);
  LabelTable labels;
  for (int32_t r = 0; r < kRobots; ++r)
    for (int32_t t = 0; t < kTopics; ++t) labels.set({RobotId{r}, TopicId{t}}, labelOf(r, TopicId{t}));
  using Map = std::unordered_map<CellIndex, Held, world::CellHash>;
  run<Map>(state, static_cast<double>(cells.size()), warm, [&](Map& map) {
    map.reserve(5'000'000);
    for (const Cell& c : cells) {
      const Held mine{labels.of({RobotId{c.robot}, c.topic}), c.robot, c.seen};
      const auto [held, is_new] = map.emplace(c.cell, mine);
      if (!is_new && held->second.seen <= c.seen) held->second = mine;
    }
  });
}

#ifdef SHOAL_HAS_OCTOMAP
// Its cells have no time: the last one told stays, which costs it nothing to find out.
template <Order order>
void OctoMap(benchmark::State& state, Scene scene, bool warm) {
  const std::vector<Cell> cells = cellsOfAll(scene, order);
  struct Tree : octomap::ColorOcTree {
    Tree() : octomap::ColorOcTree(1.0) {}
  };
  run<Tree>(state, static_cast<double>(cells.size()), warm, [&](Tree& tree) {
    for (const Cell& c : cells) {
      const octomap::OcTreeKey key(static_cast<uint16_t>(32768 + c.cell.x),
                                   static_cast<uint16_t>(32768 + c.cell.y),
                                   static_cast<uint16_t>(32768 + c.cell.z));
      const auto label = static_cast<uint32_t>(number(labelOf(c.robot, c.topic)));
      tree.updateNode(key, true, true)
          ->setColor(static_cast<uint8_t>(label >> 16), static_cast<uint8_t>(label >> 8),
                     static_cast<uint8_t>(label));
    }
  });
}

// The maps of the robots are trees too, and time is what the tree knows as occupancy: leaf by leaf the newest
// wins.
void OctoMapTrees(benchmark::State& state, Scene scene, bool warm) {
  struct Tree : octomap::ColorOcTree {
    Tree() : octomap::ColorOcTree(1.0) {
      setClampingThresMin(0.0);
      setClampingThresMax(1.0);
    }
  };
  std::vector<std::unique_ptr<Tree>> robots;
  for (int32_t r = 0; r < kRobots; ++r) {
    Tree& tree = *robots.emplace_back(std::make_unique<Tree>());
    eachCell(r, scene, kWindow, [&](const CellIndex& c, TopicId topic, world::Timestamp seen) {
      const octomap::OcTreeKey key(static_cast<uint16_t>(32768 + c.x), static_cast<uint16_t>(32768 + c.y),
                                   static_cast<uint16_t>(32768 + c.z));
      tree.setNodeValue(key, static_cast<float>(seen.us / 1'000'000), true)
          ->setColor(static_cast<uint8_t>(number(topic)), 0, 0);
    });
  }
  run<Tree>(state, kRobots * double{kWindow} * kWindow, warm, [&](Tree& merged) {
    for (int32_t r = 0; r < kRobots; ++r) {
      Tree& own = *robots[static_cast<size_t>(r)];
      for (auto leaf = own.begin_leafs(), end = own.end_leafs(); leaf != end; ++leaf) {
        const octomap::OcTreeKey key = leaf.getKey();
        const octomap::ColorOcTreeNode* held = merged.search(key);
        if (held != nullptr && held->getValue() > leaf->getValue()) continue;
        const auto label = static_cast<uint32_t>(number(labelOf(r, TopicId{leaf->getColor().r})));
        merged.setNodeValue(key, leaf->getValue(), true)
            ->setColor(static_cast<uint8_t>(label >> 16), static_cast<uint8_t>(label >> 8),
                       static_cast<uint8_t>(label));
      }
    }
  });
}
#endif

// Of the heap.
size_t heldBytes() {
  const struct mallinfo2 heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
}

// The tiles that all robots have filled, ready to be folded.
std::map<TileIndex, MapTile> tilesOfAll(Scene scene) {
  std::map<TileIndex, MapTile> tiles;
  for (int32_t r = 0; r < kRobots; ++r) {
    std::map<TileIndex, std::vector<TileCell>> said;
    eachCell(r, scene, kWindow, [&](const CellIndex& c, TopicId topic, world::Timestamp seen) {
      said[{c.x >> 4, c.y >> 4, c.z >> 4}].push_back(
          {static_cast<uint8_t>((c.x & 15) * kTileEdge + (c.y & 15)), static_cast<uint8_t>(c.z & 15), 40,
           topic, seen});
    });
    for (const auto& [index, cells] : said) tiles[index].set(RobotId{r}, cells);
  }
  return tiles;
}

// The label of every place of a tile, a number each.
template <class Rank>
GlobalLabel* writeColumn(const MapTile& tile, const GlobalLabel* of, GlobalLabel* column) {
  for (size_t s = 0; s < tile.numSheets(); ++s) {
    std::array<Rank, kTilePlaces> rank;
    std::memcpy(rank.data(), tile.shown(s).data(), sizeof rank);
    for (const Rank r : rank) *column++ = of[r];
  }
  return column;
}

// Ours: the newest of every cell with its time, robot, topic and certainty, and a label for all that is said
// in a tile, as FusedMap reads it; with a column, a label for every cell as well, written beside.
template <bool has_column>
void Fold(benchmark::State& state, Scene scene, bool warm) {
  LabelTable labels;
  for (int32_t r = 0; r < kRobots; ++r)
    for (int32_t t = 0; t < kTopics; ++t) labels.set({RobotId{r}, TopicId{t}}, labelOf(r, TopicId{t}));
  const size_t before = heldBytes();
  std::map<TileIndex, MapTile> tiles = tilesOfAll(scene);
  state.counters["MB"] = static_cast<double>(heldBytes() - before) * 1e-6;
  struct Merged {
    std::vector<GlobalLabel> labels;        // of what tiles say, each from what stands for nothing
    std::unique_ptr<GlobalLabel[]> column;  // of one sheet after the other
    std::unique_ptr<std::byte[]> newest;
  };
  std::vector<MapTile*> row;
  size_t num_sheets = 0, num_bytes = 0;
  for (auto& [index, tile] : tiles) {
    row.push_back(&tile);
    num_sheets += tile.numSheets();
    for (size_t s = 0; s < tile.numSheets(); ++s) num_bytes += tile.shown(s).size();
  }
  run<Merged>(state, kRobots * double{kWindow} * kWindow, warm, [&](Merged& merged) {
    if (has_column && !merged.column)
      merged.column = std::make_unique_for_overwrite<GlobalLabel[]>(num_sheets * kTilePlaces);
    if (!warm) merged.newest = std::make_unique_for_overwrite<std::byte[]>(num_bytes);
    GlobalLabel* column = merged.column.get();
    merged.labels.clear();
    std::byte* newest = merged.newest.get();
    for (size_t t = 0; t < row.size(); ++t) {
      MapTile& tile = *row[t];
      if (t + 8 < row.size()) __builtin_prefetch(row[t + 8]);
      if (t + 4 < row.size()) row[t + 4]->prefetch();
      tile.fold({});
      const size_t first = merged.labels.size();
      merged.labels.push_back(GlobalLabel{-1});
      tile.appendLabels(labels, merged.labels);
      const GlobalLabel* const of = merged.labels.data() + first;
      const bool is_narrow = tile.numUtterances() <= UINT8_MAX;
      if (has_column)
        column = is_narrow ? writeColumn<uint8_t>(tile, of, column) : writeColumn<uint16_t>(tile, of, column);
      for (size_t s = 0; s < tile.numSheets() && !warm; ++s)  // the tiles' own memory would be fresh too
        newest = std::ranges::copy(tile.shown(s), newest).out;
    }
    benchmark::ClobberMemory();
  });
  state.counters["sheets"] = static_cast<double>(num_sheets);
  state.counters["tiles"] = static_cast<double>(tiles.size());
}

// A robot's map as pieces.
void offer(BeliefStore& store, int32_t robot, int32_t window) {
  std::map<std::array<int32_t, 3>, BrickPart> bricks;
  eachCell(robot, Scene::kRelief, window, [&](const CellIndex& c, TopicId topic, world::Timestamp seen) {
    bricks[brickOf(c)].cells.push_back({c, topic, seen});
  });
  for (auto& [index, part] : bricks) {
    std::ranges::sort(part.cells);
    store.apply({{RobotId{robot}, PieceKind::kBrick, index}, {0, 1}, 0, 1, std::move(part)});
  }
  for (int32_t t = 0; t < kTopics; ++t) {
    store.apply({{RobotId{robot}, PieceKind::kTopic, {t, 0, 0}},
                 {0, 1},
                 0,
                 1,
                 TopicPart{{t}, 100, {100}, {{t * 5, 60}, {t * 5 + 1 + robot % 3, 40}}}});
  }
}

// A mission of twelve robots with a million cells in all: what one more brick costs a node that fuses.
BeliefStore millionCells() {
  BeliefStore store;
  for (int32_t r = 0; r < kRobots; ++r) offer(store, r, 289);
  return store;
}

Piece oneBrick(int32_t observation) {
  Random random(9, static_cast<uint64_t>(observation));
  BrickPart part;
  for (int32_t x = 0; x < 16; ++x)
    for (int32_t y = 0; y < 16; ++y) {
      part.cells.push_back({{1600 + x, 1600 + y, 0},
                            TopicId{static_cast<int32_t>(random.below(kTopics))},
                            {int64_t{observation} * 1'000'000}});
    }
  return {{RobotId{3}, PieceKind::kBrick, {100, 100, 0}}, {0, observation}, 0, 1, part};
}

void OneMoreBrickFusedMap(benchmark::State& state) {
  BeliefStore store = millionCells();
  FusedMap fused;
  fused.update(store, matching::usualMatcher());
  int32_t observation = 100'000;
  for (auto _ : state) {
    store.apply(oneBrick(++observation));
    fused.update(store, matching::usualMatcher());
    benchmark::DoNotOptimize(fused.digest());
  }
  state.counters["cells"] = static_cast<double>(fused.numCells());
}
BENCHMARK(OneMoreBrickFusedMap)->Unit(benchmark::kMillisecond);

void OneMoreBrickFusedMapCellsInARow(benchmark::State& state) {
  BeliefStore store = millionCells();
  FusedMap fused;
  int32_t observation = 100'000;
  for (auto _ : state) {
    store.apply(oneBrick(++observation));
    fused.update(store, matching::usualMatcher());
    benchmark::DoNotOptimize(fused.map());
  }
}
BENCHMARK(OneMoreBrickFusedMapCellsInARow)->Unit(benchmark::kMillisecond);

// What a console hears after it: the map as it has changed.
void OneMoreBrickTold(benchmark::State& state) {
  BeliefStore store = millionCells();
  FusedMap fused;
  MapChanges changes;
  ToldSurprises surprises;
  const auto tell = [&](const std::string& has) {
    fused.update(store, matching::usualMatcher());
    surprises.update(store);
    const MapInColumns map{1,
                           fused.digest(),
                           fused.labels(),
                           fused.columnHashes(),
                           [&fused](const auto& columns) { return fused.cellsIn(columns); },
                           [&surprises](const auto& cells) { return surprises.of(cells); }};
    return changes.answer(map, {{"query", "map"}, {"has", has}});
  };
  std::string has = tell("").at("digest");
  int32_t observation = 100'000;
  size_t bytes = 0;
  for (auto _ : state) {
    store.apply(oneBrick(++observation));
    const auto answer = tell(has);
    has = answer.at("digest");
    bytes = answer.dump().size();
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(OneMoreBrickTold)->Unit(benchmark::kMillisecond);

void OneMoreBrickPlainly(benchmark::State& state) {
  BeliefStore store = millionCells();
  int32_t observation = 100'000;
  for (auto _ : state) {
    store.apply(oneBrick(++observation));
    benchmark::DoNotOptimize(fusePlainly(store, matching::usualMatcher()).digest());
  }
}
BENCHMARK(OneMoreBrickPlainly)->Unit(benchmark::kMillisecond)->Iterations(2);

// From pieces to the fused map, nothing known before.
void WholeFusedMapFromPieces(benchmark::State& state) {
  const BeliefStore store = millionCells();
  for (auto _ : state) {
    FusedMap fused;
    fused.update(store, matching::usualMatcher());
    benchmark::DoNotOptimize(fused.digest());
  }
}
BENCHMARK(WholeFusedMapFromPieces)->Unit(benchmark::kMillisecond)->Iterations(3);

#define IN_SCENE(Structure, name, scene, is_warm, iterations) \
  BENCHMARK_CAPTURE(Structure, name, scene, is_warm)->Unit(benchmark::kMillisecond)->Iterations(iterations)
#define BOTH_WAYS(Structure, iterations)                               \
  IN_SCENE(Structure, relief_cold, Scene::kRelief, false, iterations); \
  IN_SCENE(Structure, relief_warm, Scene::kRelief, true, iterations);  \
  IN_SCENE(Structure, rough_cold, Scene::kRough, false, iterations);   \
  IN_SCENE(Structure, rough_warm, Scene::kRough, true, iterations);    \
  IN_SCENE(Structure, flat_cold, Scene::kFlat, false, iterations);     \
  IN_SCENE(Structure, flat_warm, Scene::kFlat, true, iterations)
constexpr auto Tiles = Fold<false>;
constexpr auto TilesWithColumn = Fold<true>;
BOTH_WAYS(Tiles, 5);
BOTH_WAYS(TilesWithColumn, 5);
constexpr auto UnorderedMapRows = UnorderedMap<Order::kLawnmower>;
constexpr auto UnorderedMapLeaves = UnorderedMap<Order::kLeaves>;
constexpr auto UnorderedMapScattered = UnorderedMap<Order::kScattered>;
BOTH_WAYS(UnorderedMapRows, 2);
BOTH_WAYS(UnorderedMapLeaves, 2);
BOTH_WAYS(UnorderedMapScattered, 2);
#ifdef SHOAL_HAS_OCTOMAP
constexpr auto OctoMapRows = OctoMap<Order::kLawnmower>;
constexpr auto OctoMapLeaves = OctoMap<Order::kLeaves>;
constexpr auto OctoMapScattered = OctoMap<Order::kScattered>;
BOTH_WAYS(OctoMapRows, 1);
BOTH_WAYS(OctoMapLeaves, 1);
BOTH_WAYS(OctoMapScattered, 1);
BOTH_WAYS(OctoMapTrees, 1);
#endif

const char* const kNames[] = {"OneMoreBrick",          "WholeFusedMap",    "Tiles",
                              "TilesWithColumn",       "UnorderedMapRows", "UnorderedMapLeaves",
                              "UnorderedMapScattered", "OctoMapRows",      "OctoMapLeaves",
                              "OctoMapScattered",      "OctoMapTrees"};

}  // namespace

int main(int argc, char** argv) {
  bool filtered = false;
  for (int i = 1; i < argc; ++i)
    filtered = filtered || std::string(argv[i]).starts_with("--benchmark_filter") ||
               std::string(argv[i]).starts_with("--benchmark_list");
  if (!filtered) {
    std::string command = std::string("'") + argv[0] + "'";
    for (int i = 1; i < argc; ++i) command += std::string(" '") + argv[i] + "'";
    for (const char* name : kNames) {
      for (const char* scene :
           {"relief_cold", "relief_warm", "rough_cold", "rough_warm", "flat_cold", "flat_warm", ""}) {
        const bool whole = std::string(name).find("Brick") != std::string::npos || *name == 'W';
        if (whole != (*scene == 0)) continue;
        const std::string filter = std::string(name) + (whole ? "" : "/") + scene;
        const int status = std::system((command + " '--benchmark_filter=^" + filter + "'").c_str());
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return 1;
      }
    }
    return 0;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
