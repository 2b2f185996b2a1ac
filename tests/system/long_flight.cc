// SPDX-License-Identifier: BSD-3-Clause
// Not a test: what an image costs a robot as its map grows. One agent flies the same stretch of reef again
// and again, each time a stretch further on, so that pictures are real, rendered once, and cells are new.
//
//     build/bin/shoal_long_flight [IMAGES [CELL_SIZE_M [BUDGET [CHECKPOINT_DIR]]]]
//
// Milliseconds of CPU of the thread that flies, by thousands of images.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fusion_node/process.h"
#include "robot_agent/agent.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/cpu_time.h"
#include "shoal/world/place.h"

namespace shoal {
namespace {

constexpr int32_t kImagesOfAStretch = 400;
constexpr int32_t kStretchesInARow = 8;
constexpr size_t kImagesInARow = 1000;  // of the table
constexpr double kPauseMs = 50;

// The whole of a small reef, and then the same beside it.
class EndlessReef final : public world::ObservationSource {
 public:
  EndlessReef(int32_t images, std::function<void()> begins) : images_(images), begins_(std::move(begins)) {
    const auto place = world::openPlace("reef:varied");
    world::SurveyOptions survey;
    survey.observations = kImagesOfAStretch;
    extent_ = *place->extent();
    const auto source = place->source(survey, 0);
    while (auto observation = source->next()) stretch_.push_back(std::move(*observation));
  }

  std::optional<world::Observation> next() override {
    begins_();
    if (number_ == images_) {
      std::raise(SIGINT);  // nobody is there to be told the rest
      return std::nullopt;
    }
    const auto size = static_cast<int32_t>(stretch_.size());
    world::Observation observation = stretch_[static_cast<size_t>(number_ % size)];
    const int32_t lap = number_ / size;
    observation.number = number_;
    observation.time.us = int64_t{1'000'000} * number_;
    observation.world_from_camera.pretranslate(
        Eigen::Vector3d{(lap % kStretchesInARow) * (extent_.max_x - extent_.min_x),
                        (lap / kStretchesInARow) * (extent_.max_y - extent_.min_y), 0});
    ++number_;
    return observation;
  }
  std::optional<int32_t> numObservations() const override { return images_; }

 private:
  const int32_t images_;
  std::function<void()> begins_;
  world::Extent extent_{};
  std::vector<world::Observation> stretch_;
  int32_t number_ = 0;
};

struct Row {
  robot_agent::ImageTimes times;
  double all_ms = 0;  // sending and listening included, of the second that follows
  double image_ms() const { return times.stages.total() + times.publish_ms + times.save_ms; }
};

double at(std::vector<double> values, double part) {
  const auto i = static_cast<size_t>(part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + static_cast<ptrdiff_t>(i));
  return values[i];
}

void print(const std::vector<Row>& rows, size_t first) {
  const size_t last = std::min(first + kImagesInARow, rows.size());
  const auto column = [&](const char* name, const std::function<double(const Row&)>& of) {
    std::vector<double> values;
    for (size_t i = first; i < last; ++i) values.push_back(of(rows[i]));
    std::printf(" %s %.1f %.1f %.1f |", name, at(values, .5), at(values, .99), at(values, 1));
  };
  std::printf("%6zu, %d cells |", last, rows[last - 1].times.num_cells);
  column("words", [](const Row& r) { return r.times.stages.words_ms; });
  column("topics", [](const Row& r) { return r.times.stages.topics_ms; });
  column("belief", [](const Row& r) { return r.times.stages.belief_ms; });
  column("pictures", [](const Row& r) { return r.times.stages.pictures_ms; });
  column("publish", [](const Row& r) { return r.times.publish_ms; });
  column("save", [](const Row& r) { return r.times.save_ms; });
  column("image", [](const Row& r) { return r.image_ms(); });
  column("all", [](const Row& r) { return r.all_ms; });
  size_t slow = 0;
  for (size_t i = first; i < last; ++i) slow += rows[i].all_ms > kPauseMs;
  std::printf(" %zu above %.0f\n", slow, kPauseMs);
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  const int32_t images = argc > 1 ? std::atoi(argv[1]) : 10'000;
  robot_agent::AgentOptions options;
  options.explorer.cell_size_m = argc > 2 ? std::atof(argv[2]) : 1.25;
  options.explorer.keeps_pictures = true;
  options.budget = argc > 3 ? std::atoi(argv[3]) : 2000;
  options.checkpoint_dir = argc > 4 ? argv[4] : "";
  options.rate = 0;
  std::vector<Row> rows;
  Row row;
  double began_ms = 0;
  std::printf("images | median, 99 %%, largest of each\n");
  EndlessReef reef(images, [&] {
    const double now_ms = threadCpuMs();
    row.all_ms = now_ms - began_ms;
    if (began_ms > 0) {
      rows.push_back(row);
      if (rows.size() % kImagesInARow == 0) print(rows, rows.size() - kImagesInARow);
      if (row.all_ms > kPauseMs)
        std::printf(
            "image %zu: words %.1f topics %.1f belief %.1f pictures %.1f publish %.1f save %.1f all %.1f\n",
            rows.size(), row.times.stages.words_ms, row.times.stages.topics_ms, row.times.stages.belief_ms,
            row.times.stages.pictures_ms, row.times.publish_ms, row.times.save_ms, row.all_ms);
    }
    row = {};
    began_ms = threadCpuMs();
  });
  fusion_node::setUpLog("R00", "warn");
  fusion_node::catchStopSignals();
  options.watch = [&](const robot_agent::ImageTimes& times) { row.times = times; };
  comms::MemoryNetwork network;
  const auto bus = network.connect();
  robot_agent::Agent agent(options, reef, *bus);
  agent.run();
  std::printf("landing took %.0f ms of CPU\n", threadCpuMs() - began_ms);
  return 0;
}

}  // namespace
}  // namespace shoal

int main(int argc, char** argv) { return shoal::run(argc, argv); }
