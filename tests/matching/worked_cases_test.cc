// SPDX-License-Identifier: BSD-3-Clause
// CLEAR on the worked cases beside the test data: graphs with hand-checked answers, the outputs of three
// reference implementations, and whether these agree. Equality is demanded where the answer is stable, else
// what any right answer has: see the README of the cases.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "match_file.h"
#include "shoal/matching/clear.h"
#include "shoal/matching/clustering.h"
#include "shoal/matching/matcher.h"

namespace shoal::matching {
namespace {

using nlohmann::json;

std::filesystem::path folder() {
  const char* data = std::getenv("SHOAL_DATA");
  return std::filesystem::path(data == nullptr ? "." : data) / ".." / "cases" / "clear";
}

json readJson(const std::filesystem::path& path) {
  std::ifstream file(path);
  return json::parse(file);
}

std::vector<std::string> caseNames() {
  std::vector<std::string> names;
  if (!std::filesystem::exists(folder() / "index.json")) return names;
  for (const json& entry : readJson(folder() / "index.json"))
    names.push_back(entry["name"].get<std::string>());
  return names;
}

std::vector<int> canonical(const json& labels) {
  const auto raw = labels.get<std::vector<int>>();
  return numberByFirstAppearance(raw, static_cast<int>(raw.size())).label;
}

// F1 over the pairs of labels of different robots.
double f1(const std::vector<int>& label, const std::vector<int>& truth, const std::vector<int>& owner) {
  double both = 0, of_label = 0, of_truth = 0;
  for (size_t v = 0; v < label.size(); ++v) {
    for (size_t w = 0; w < v; ++w) {
      if (owner[v] == owner[w]) continue;
      const bool joined = label[v] == label[w];
      const bool same = truth[v] == truth[w];
      both += joined && same;
      of_label += joined;
      of_truth += same;
    }
  }
  return of_label + of_truth > 0 ? 2 * both / (of_label + of_truth) : 1.0;
}

TEST(WorkedCasesTest, AreThere) { EXPECT_EQ(caseNames().size(), 31u) << "no cases in " << folder(); }

class WorkedCase : public ::testing::TestWithParam<std::string> {};

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(WorkedCase);
INSTANTIATE_TEST_SUITE_P(All, WorkedCase, ::testing::ValuesIn(caseNames()),
                         [](const auto& name) { return name.param; });

TEST_P(WorkedCase, IsSolvedThroughTheConsole) {
  const std::filesystem::path path = folder() / (GetParam() + ".json");
  const json example = readJson(path);
  console::MatchFileOptions options;
  options.path = path.string();
  options.matcher = "clear";
  options.json = true;
  std::ostringstream out;
  std::ostringstream err;
  ASSERT_EQ(console::runMatch(options, out, err), 0) << err.str();
  EXPECT_EQ(err.str().empty(), GetParam() != "tiny_one_robot") << err.str();  // its edges are inside a robot
  const json result = json::parse(out.str());
  const auto label = result["labels"].get<std::vector<int>>();

  AssociationGraph graph{example["counts"].get<std::vector<int>>(), {}};
  const std::vector<int> owner = owners(graph);
  ASSERT_EQ(label.size(), owner.size());
  EXPECT_EQ(result["universe"], example["universe_exact"]);
  EXPECT_EQ(canonical(result["labels"]), label);

  std::set<std::pair<int, int>> used;
  for (size_t v = 0; v < label.size(); ++v)
    EXPECT_TRUE(used.emplace(owner[v], label[v]).second) << "vertex " << v;

  const json expect = example.value("expect", json::object());
  if (expect.contains("m")) {
    EXPECT_EQ(result["universe"], expect["m"]);
  }
  if (expect.contains("labels")) {
    EXPECT_EQ(label, canonical(expect["labels"]));
  } else if (example["stable_partition"].get<bool>()) {
    EXPECT_EQ(label, canonical(example["reference"]["python"]["labels"]));
  } else if (example.contains("scores") && !example["truth"].is_null()) {
    double least = 1.0;
    for (const auto& [version, score] : example["scores"].items()) {
      if (example["reference"].contains(version)) least = std::min(least, score["f1"].get<double>());
    }
    EXPECT_GE(f1(label, example["truth"].get<std::vector<int>>(), owner), least - .05);
  }
}

DescriptorSet readDescriptors(const json& example) {
  DescriptorSet topics;
  topics.vocabulary_size = example["vocabulary"].get<int>();
  std::ifstream file(folder() / example["descriptors"].get<std::string>());
  for (const int count : example["counts"]) {
    std::vector<Descriptor>& robot = topics.robots.emplace_back();
    for (int k = 0; k < count; ++k) {
      std::string line;
      do std::getline(file, line);
      while (line.starts_with('#'));
      std::istringstream words(line);
      Descriptor& topic = robot.emplace_back();
      topic.slot = k;
      int word = 0;
      char colon = 0;
      for (int64_t weight = 0; words >> word >> colon >> weight;) topic.entries.push_back({word, weight});
    }
  }
  check(topics);
  return topics;
}

// Our own similarity and threshold make the edges of the file, and so its answer.
TEST(WorkedCasesTest, WithDescriptorsHaveTheirEdgesAndTheirAnswer) {
  for (const std::string name : {"desc_V100_mid_cos", "desc_V1500_mid_cos"}) {
    SCOPED_TRACE(name);
    const json example = readJson(folder() / (name + ".json"));
    const DescriptorSet topics = readDescriptors(example);
    MatcherOptions options;
    options.similarity = example["metric"].get<std::string>();
    options.sigma = example["sigma"].get<double>();
    const AssociationGraph graph =
        associationGraph(topics, similarityNamed(options.similarity), options.leastSimilarity());
    std::set<std::pair<int, int>> expected;
    for (const json& e : example["edges"]) expected.emplace(e[0].get<int>(), e[1].get<int>());
    std::set<std::pair<int, int>> found;
    for (const Edge& e : graph.edges) found.emplace(e.i, e.j);
    EXPECT_EQ(found, expected);
    EXPECT_EQ(match(topics, options).label, canonical(example["reference"]["python"]["labels"]));
  }
}

}  // namespace
}  // namespace shoal::matching
