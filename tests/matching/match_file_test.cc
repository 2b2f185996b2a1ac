// SPDX-License-Identifier: BSD-3-Clause
#include "match_file.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <vector>

#include "match_input.h"

namespace shoal::console {
namespace {

struct Outcome {
  int code = 0;
  std::string out;
  std::string err;

  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

Outcome run(const std::string& text, MatchFileOptions options = {}) {
  if (options.path.empty()) options.path = "-";
  options.json = true;
  std::istringstream in(text);
  std::ostringstream out;
  std::ostringstream err;
  const int code = runMatch(options, in, out, err);
  return {code, out.str(), err.str()};
}

using Labels = std::vector<int>;

const std::string kRobots =
    R"({"vocabulary":6,"groups":[{"name":"a","first":0,"size":4},{"name":"b","first":4,"size":2}],
  "robots":[{"name":"R00","topics":[{"id":3,"words":{"0":9,"1":1}},{"id":4,"words":{"2":5,"3":5}}]},
            {"name":"R01","topics":[{"id":4,"words":{"2":4,"3":6}},{"id":5,"words":{"0":8,"1":2}}]}]})";

TEST(RunMatchTest, MatchesAGraph) {
  const Outcome outcome = run(R"({"counts":[2,0,2],"edges":[[0,3],[2,1,0.5]],"anything":"else"})");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out,
            "{\"universe\":2,\"used\":2,\"labels\":[0,1,1,0],\"sigma\":null,\"matcher\":\"clear\"}\n");
  EXPECT_EQ(outcome.err, "");
}

TEST(RunMatchTest, MatchesTopicsOfRobots) {
  const Outcome outcome = run(kRobots);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["labels"].get<Labels>(), (Labels{0, 1, 1, 0}));
  EXPECT_EQ(outcome.json()["sigma"], .75);
  EXPECT_FALSE(outcome.json().contains("seconds"));
}

TEST(RunMatchTest, LetsFlagsBeatTheFile) {
  std::string text = kRobots;
  text.insert(1, R"("sigma":0.999,"similarity":"overlap","matcher":"clear",)");
  EXPECT_EQ(run(text).json()["labels"].get<Labels>(), (Labels{0, 1, 2, 3}));
  EXPECT_EQ(run(text).json()["sigma"], .999);
  MatchFileOptions flags;
  flags.sigma = "0.6";
  EXPECT_EQ(run(text, flags).json()["labels"].get<Labels>(), (Labels{0, 1, 1, 0}));
  flags.matcher = "hungarian";
  EXPECT_EQ(run(text, flags).json()["matcher"], "hungarian");
  EXPECT_TRUE(run(text, flags).json()["sigma"].is_null());
}

TEST(RunMatchTest, MatchesByIdWhereThereAreIdsAndByPlaceWhereThereAreNone) {
  MatchFileOptions flags;
  flags.matcher = "id";
  EXPECT_EQ(run(kRobots, flags).json()["labels"].get<Labels>(), (Labels{0, 1, 1, 2}));
  EXPECT_EQ(
      run(R"({"vocabulary":1,"robots":[{"topics":[{"words":{}},{"words":{}}]},{"topics":[{"words":{}}]}]})",
          flags)
          .json()["labels"]
          .get<Labels>(),
      (Labels{0, 1, 0}));
}

TEST(RunMatchTest, JoinsARobotsOwnLabelsWithShoalUnlessTheyAreToStayDistinct) {
  const std::string text = R"({"vocabulary":3,"matcher":"shoal","sigma":"auto","robots":[{"topics":[)"
                           R"({"words":{"0":90,"1":10}},{"words":{"0":90,"1":11}},{"words":{"2":100}}]},)"
                           R"({"topics":[{"words":{"0":91,"1":9}}]}]})";
  const Outcome joined = run(text);
  EXPECT_EQ(joined.json()["labels"].get<Labels>(), (Labels{0, 0, 1, 0})) << joined.err;
  EXPECT_EQ(joined.json()["sigma"], .25);
  EXPECT_EQ(joined.json()["universe"], 2);
  MatchFileOptions flags;
  flags.distinct = true;
  const Labels labels = run(text, flags).json()["labels"].get<Labels>();
  EXPECT_NE(labels[0], labels[1]);
}

TEST(RunMatchTest, TimesTheMatchingWhenAsked) {
  MatchFileOptions flags;
  flags.timing = true;
  EXPECT_GE(run(kRobots, flags).json()["seconds"].get<double>(), 0.0);
}

TEST(RunMatchTest, IgnoresEdgesInsideARobotWithAWarning) {
  const Outcome outcome = run(R"({"counts":[2,1],"edges":[[1,0],[0,2],[1,1]]})");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.json()["labels"].get<Labels>(), (Labels{0, 1, 0}));
  EXPECT_NE(outcome.err.find("warning: 2 edge(s) inside a robot ignored, the first is edges[0] = [1,0]"),
            std::string::npos)
      << outcome.err;
}

TEST(RunMatchTest, WritesTextForPeople) {
  MatchFileOptions flags;
  flags.path = "-";
  std::istringstream in(kRobots);
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(runMatch(flags, in, out, err), 0);
  EXPECT_EQ(out.str(), "clear: 2 labels in use of 2\nR00: 0 1\nR01: 1 0\n");
}

TEST(RunMatchTest, ReadsFilesAndSaysWhichItCannotRead) {
  const std::string path = ::testing::TempDir() + "shoal_match_file_test.json";
  std::ofstream(path) << kRobots;
  MatchFileOptions flags;
  flags.path = path;
  EXPECT_EQ(run("", flags).json()["used"], 2);
  std::ofstream(path, std::ios::trunc) << "{]";
  EXPECT_EQ(run("", flags).code, 1);
  EXPECT_NE(run("", flags).err.find(path), std::string::npos);
  std::remove(path.c_str());
  EXPECT_EQ(run("", flags).code, 1);
  EXPECT_NE(run("", flags).err.find(path), std::string::npos);
  flags.path = ::testing::TempDir();  // a folder
  EXPECT_EQ(run("", flags).code, 1);
}

struct Bad {
  const char* text;
  const char* named;  // what the message must name
};

// Every kind of bad content: exit code 1, nothing on stdout, one line that names the place.
TEST(RunMatchTest, RejectsBadContentInOneLine) {
  const Bad cases[] = {
      {"", "JSON"},
      {"{\n\"counts\":\n[1,", "JSON"},
      {"[]", "object"},
      {"3", "object"},
      {"{}", "\"counts\""},
      {R"({"counts":[1,1]})", "\"edges\""},
      {R"({"edges":[]})", "\"counts\""},
      {R"({"counts":3,"edges":[]})", "counts"},
      {R"({"counts":[1,-1],"edges":[]})", "counts[1]"},
      {R"({"counts":[1.5],"edges":[]})", "counts[0]"},
      {R"({"counts":["2"],"edges":[]})", "counts[0]"},
      {R"({"counts":[99999999999999999999],"edges":[]})", "counts[0]"},
      {R"({"counts":[18446744073709551615],"edges":[]})", "counts[0]"},
      {R"({"counts":[10001],"edges":[]})", "counts[0]"},
      {R"({"counts":[1,1],"edges":7})", "edges"},
      {R"({"counts":[1,1],"edges":[[0]]})", "edges[0]"},
      {R"({"counts":[1,1],"edges":[[0,1,1,1]]})", "edges[0]"},
      {R"({"counts":[1,1],"edges":[{"i":0}]})", "edges[0]"},
      {R"({"counts":[1,1],"edges":[[0,2]]})", "edges[0][1]"},
      {R"({"counts":[1,1],"edges":[[-1,1]]})", "edges[0][0]"},
      {R"({"counts":[1,1],"edges":[[0,0.5]]})", "edges[0][1]"},
      {R"({"counts":[0],"edges":[[0,0]]})", "edges[0]"},
      {R"({"counts":[1,1],"edges":[[0,1,-0.1]]})", "edges[0][2]"},
      {R"({"counts":[1,1],"edges":[[0,1,NaN]]})", "JSON"},
      {R"({"counts":[1,1],"edges":[[0,1,1e999]]})", "JSON"},
      {R"({"counts":[1,1],"edges":[[0,1,null]]})", "edges[0][2]"},
      {R"({"counts":[1,1],"edges":[[0,1],[0,1]]})", "edges[1] repeats edges[0]"},
      {R"({"counts":[1,1],"edges":[[0,1],[1,0,0.5]]})", "edges[1] repeats edges[0]"},
      {R"({"counts":[1,1],"edges":[[0,1,1e308]],"edges":[]})", "\"edges\" is there twice"},
      {R"({"counts":[1,1,1],"edges":[[0,1,1.7e308],[0,2,1.7e308]]})", "vertex 0"},
      {R"({"robots":[]})", "\"vocabulary\""},
      {R"({"vocabulary":-1,"robots":[]})", "vocabulary"},
      {R"({"vocabulary":5,"robots":{}})", "robots"},
      {R"({"vocabulary":5,"robots":[{}]})", "robots[0]"},
      {R"({"vocabulary":5,"robots":[{"name":7,"topics":[]}]})", "name"},
      {R"({"vocabulary":5,"robots":[{"name":"A","topics":[]},{"name":"A","topics":[]}]})", "\"A\""},
      {R"({"vocabulary":5,"robots":[{"topics":[{}]}]})", "robots[0].topics[0]"},
      {R"({"vocabulary":5,"robots":[{"topics":[{"words":[1,2]}]}]})", "robots[0].topics[0].words"},
      {R"({"vocabulary":5,"robots":[{"topics":[{"words":{"5":1}}]}]})", "\"5\""},
      {R"({"vocabulary":5,"robots":[{"topics":[{"words":{"-1":1}}]}]})", "\"-1\""},
      {R"({"vocabulary":5,"robots":[{"topics":[{"words":{"1x":1}}]}]})", "\"1x\""},
      {R"({"vocabulary":5,"robots":[{"topics":[{"words":{"":1}}]}]})", "\"\""},
      {R"({"vocabulary":5,"robots":[{"topics":[{"words":{"1":-3}}]}]})", "words.1"},
      {R"({"vocabulary":5,"robots":[{"topics":[{"words":{"1":0.5}}]}]})", "words.1"},
      {R"({"vocabulary":5,"robots":[{"topics":[{"words":{"1":3,"1":4}}]}]})", "twice"},
      {R"({"vocabulary":5,"robots":[{"topics":[{"words":{"1":3,"01":4}}]}]})", "word 1"},
      {R"({"vocabulary":5,"robots":[{"topics":[{"id":10000,"words":{}}]}]})", "id"},
      {R"({"vocabulary":5,"robots":[],"groups":[{"name":"a","first":0,"size":4}]})", "groups"},
      {R"({"vocabulary":5,"robots":[],"groups":[{"name":"a","first":1,"size":4}]})", "groups[0].first"},
      {R"({"vocabulary":5,"robots":[],"groups":[{"name":"a","first":0,"size":6}]})", "groups[0].size"},
      {R"({"vocabulary":5,"robots":[],"groups":[{"first":0,"size":5}]})", "groups[0]"},
      {R"({"vocabulary":5,"robots":[],"groups":3})", "groups"},
      {R"({"vocabulary":5,"robots":[],"sigma":"much"})", "sigma"},
      {R"({"vocabulary":5,"robots":[],"sigma":1.5})", "sigma"},
      {R"({"vocabulary":5,"robots":[],"sigma":[]})", "sigma"},
      {R"({"vocabulary":5,"robots":[],"similarity":"jaccard"})", "jaccard"},
      {R"({"vocabulary":5,"robots":[],"matcher":"clera"})", "unknown"},
  };
  for (const Bad& bad : cases) {
    const Outcome outcome = run(bad.text);
    SCOPED_TRACE(std::string(bad.text) + "\n" + outcome.err);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find(bad.named), std::string::npos);
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1);
  }
}

TEST(RunMatchTest, RejectsBadOptionsBeforeItReads) {
  MatchFileOptions matcher, similarity, sigma, word;
  matcher.matcher = "clera";
  similarity.similarity = "jaccard";
  sigma.sigma = "1.5";
  word.sigma = "0.75x";
  for (const MatchFileOptions& flags : {matcher, similarity, sigma, word}) {
    const Outcome outcome = run(kRobots, flags);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1);
  }
}

TEST(RunMatchTest, MatchesAGraphByItsComponentsWhenAsked) {
  MatchFileOptions flags;
  flags.matcher = "components";
  flags.json = true;
  const Outcome outcome = run(R"({"counts":[1,1,2],"edges":[[0,1],[1,2]]})", flags);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["labels"], (std::vector{0, 0, 0, 1}));
}

TEST(RunMatchTest, RefusesMatchersOfWordsForAGraph) {
  MatchFileOptions flags;
  flags.matcher = "hungarian";
  const Outcome outcome = run(R"({"counts":[1,1],"edges":[[0,1]]})", flags);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("\"hungarian\""), std::string::npos);
}

// Blanks without end, as from a pipe.
class Endless : public std::streambuf {
 private:
  int_type underflow() override {
    setg(chunk_, chunk_, chunk_ + sizeof(chunk_));
    return traits_type::to_int_type(chunk_[0]);
  }
  char chunk_[64] = "                                                               ";
};

TEST(ReadMatchInputTest, StopsReadingEndlessInput) {
  Endless endless;
  std::istream in(&endless);
  EXPECT_THROW(readMatchInput(in, 1 << 20), std::invalid_argument);
}

TEST(ReadMatchInputTest, RefusesDeepNesting) {
  std::istringstream in(std::string(5'000'000, '['));
  EXPECT_THROW(readMatchInput(in), std::invalid_argument);
}

TEST(ReadMatchInputTest, RefusesMoreLabelsThanAnybodyHas) {
  std::string text = R"({"edges":[],"counts":[10000)";
  for (int robot = 0; robot < 20; ++robot) text += ",10000";
  std::istringstream in(text + "]}");
  EXPECT_THROW(readMatchInput(in), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::console
