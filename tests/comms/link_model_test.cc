// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/link_model.h"

#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "shoal/comms/fading.h"

namespace shoal::comms {
namespace {

std::string complaint(const std::string& text) {
  try {
    parseLink(text, "bay.json");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(LinkModelTest, PresetsAreInOrderAndOnlyCleanIsClean) {
  for (const std::string name : {"clean", "mesh", "acoustic", "satellite"}) {
    SCOPED_TRACE(name);
    const auto link = linkPreset(name);
    ASSERT_TRUE(link);
    EXPECT_NO_THROW(check(*link));
    EXPECT_EQ(link->isClean(), name == "clean");
    EXPECT_EQ(readLink(name).rate_bytes_per_s, link->rate_bytes_per_s);
  }
  EXPECT_FALSE(linkPreset("string"));
}

TEST(LinkModelTest, AFileSaysEverything) {
  const LinkModel link = parseLink(R"({
    // as seen last summer
    "rate_bytes_per_s": 80, "queue_s": 30, "delay_s": 0.5, "jitter_s": 0.25, "loss": 0.125,
    "bursts": {"good_s": 10, "bad_s": 2, "loss": 0.75},
    "reordering": 0.1, "duplication": 0.2, "late_s": 3, "range_m": 300, "base_m": [1, -2, 3.5],
    "partitions": [{"from_s": 10, "until_s": 70, "groups": [["R00", "R01"], ["R02", "OPERATOR"]]}]
  })",
                                   "bay.json");
  EXPECT_EQ(link.rate_bytes_per_s, 80);
  EXPECT_EQ(link.queue_s, 30);
  EXPECT_EQ(link.delay_s, 0.5);
  EXPECT_EQ(link.jitter_s, 0.25);
  EXPECT_EQ(link.loss, 0.125);
  EXPECT_EQ(link.bursts.good_s, 10);
  EXPECT_EQ(link.bursts.bad_s, 2);
  EXPECT_EQ(link.bursts.loss, 0.75);
  EXPECT_EQ(link.reordering, 0.1);
  EXPECT_EQ(link.duplication, 0.2);
  EXPECT_EQ(link.late_s, 3);
  EXPECT_EQ(link.range_m, 300);
  EXPECT_EQ(link.base_m.value(), (std::array{1.0, -2.0, 3.5}));
  ASSERT_EQ(link.partitions.size(), 1u);
  EXPECT_EQ(link.partitions[0].from_s, 10);
  EXPECT_EQ(link.partitions[0].until_s, 70);
  EXPECT_EQ(link.partitions[0].groups,
            (std::vector<std::vector<std::string>>{{"R00", "R01"}, {"R02", "OPERATOR"}}));
}

TEST(LinkModelTest, AFileMayBeLikeAPreset) {
  const LinkModel link =
      parseLink(R"({"loss": 0.3, "bursts": {"bad_s": 9}, "like": "acoustic"})", "bay.json");
  const LinkModel acoustic = *linkPreset("acoustic");
  EXPECT_EQ(link.loss, 0.3);
  EXPECT_EQ(link.bursts.bad_s, 9);
  EXPECT_EQ(link.bursts.good_s, acoustic.bursts.good_s);
  EXPECT_EQ(link.rate_bytes_per_s, acoustic.rate_bytes_per_s);
  EXPECT_TRUE(parseLink("{}", "bay.json").isClean());
}

TEST(LinkModelTest, NamesTheFileAndTheFieldThatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"loss": 1.5})", "\"loss\" must lie in [0, 1], got 1.5"},
      {R"({"loss": "much"})", "\"loss\" must be a number, got \"much\""},
      {R"({"delay_s": -1})", "\"delay_s\" must lie in [0, 1000000] s, got -1"},
      {R"({"rate_bytes_per_s": 0.5})", "\"rate_bytes_per_s\" must be 0 (no limit) or at least 1"},
      {R"({"range_m": -4})", "\"range_m\" must be 0 (no limit) or more, got -4"},
      {R"({"base_m": [1, 2]})", "\"base_m\" must be three numbers"},
      {R"({"bursts": {"good_s": 0}})", "\"bursts.good_s\" must be at least 0.001 s, got 0"},
      {R"({"bursts": {"bad": 3}})", "\"bursts.bad\" is not known; there are bad_s, good_s, loss"},
      {R"({"bursts": 3})", "\"bursts.\" must be an object"},
      {R"({"lost": 0.1})", "\"lost\" is not known; there are base_m, bursts,"},
      {R"({"like": "wifi"})", "\"like\" must be clean, mesh, acoustic or satellite, got \"wifi\""},
      {R"({"like": 7})", "\"like\" must be"},
      {R"({"partitions": {}})", "\"partitions\" must be a list"},
      {R"({"partitions": [{"from_s": 5, "until_s": 5, "groups": [["R00"]]}]})",
       "\"partitions[0].until_s\" must be later than from_s, got 5"},
      {R"({"partitions": [{"from_s": 0, "until_s": 5}]})", "\"partitions[0].groups\" must name"},
      {R"({"partitions": [{"groups": ["R00"]}]})", "\"partitions[0].groups\" must be a list of lists"},
      {R"({"partitions": [{"from_s": 0, "until_s": 5, "groups": [["r00"]]}]})", "names \"r00\"; nodes are"},
      {R"({"partitions": [{"from_s": 0, "until_s": 5, "groups": [["R00"], ["R00"]]}]})", "names R00 twice"},
      {R"([])", "a link is a JSON object"},
      {R"({"loss": 0.1)", "broken JSON"},
      {R"({"loss": 1e999})", "broken JSON"},
  };
  for (const auto& [text, said] : cases) {
    EXPECT_NE(complaint(text).find(said), std::string::npos) << text << "\nsaid: " << complaint(text);
    EXPECT_EQ(complaint(text).rfind("the link bay.json: ", 0), 0u) << complaint(text);
  }
}

TEST(LinkModelTest, ReadsFilesAndNamesThoseThatAreNot) {
  const std::string path = testing::TempDir() + "link_model_test.json";
  std::ofstream(path) << R"({"loss": 0.5})";
  EXPECT_EQ(readLink(path).loss, 0.5);
  try {
    readLink("no/such/link");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("no/such/link is neither clean"), std::string::npos);
  }
  EXPECT_THROW(readLink("/"), std::invalid_argument);
}

// Bad for 2 of 10 seconds in the mean, and a bad time lasts 2 s in the mean. In 50 000 s there are 5000:
// their share of the time has a standard deviation of 0.003, their mean length one of 1.4 %, and it is taken
// for longer by as much because those under 50 ms are often missed.
TEST(FadingTest, IsBadAsOftenAndAsLongAsTold) {
  const Bursts bursts{.good_s = 8, .bad_s = 2, .loss = 1};
  constexpr int64_t kStepUs = 50'000;
  constexpr int64_t kSteps = 1'000'000;
  int64_t bad = 0;
  int64_t times = 0;
  bool before = false;
  for (int64_t i = 0; i < kSteps; ++i) {
    const bool now = isBad(bursts, 5, i * kStepUs);
    bad += now ? 1 : 0;
    times += now && !before ? 1 : 0;
    before = now;
  }
  EXPECT_NEAR(static_cast<double>(bad) / kSteps, 0.2, 0.013);
  EXPECT_NEAR(static_cast<double>(bad) * 0.05 / static_cast<double>(times), 2.03, 0.12);
}

TEST(FadingTest, DependsOnTheKeyAndTheTimeAlone) {
  const Bursts bursts{.good_s = 1, .bad_s = 1, .loss = 1};
  int alike = 0;
  for (int64_t i = 0; i < 10'000; ++i) {
    EXPECT_EQ(isBad(bursts, 1, i * 700'000), isBad(bursts, 1, i * 700'000));
    alike += isBad(bursts, 1, i * 700'000) == isBad(bursts, 2, i * 700'000) ? 1 : 0;
  }
  EXPECT_NEAR(alike, 5000, 400);
  EXPECT_FALSE(isBad({.good_s = 1, .bad_s = 0, .loss = 1}, 1, 5));
  isBad(bursts, 1, (int64_t{1} << 62) - 1);  // ends
}

}  // namespace
}  // namespace shoal::comms
