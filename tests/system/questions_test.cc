// SPDX-License-Identifier: BSD-3-Clause
// What people ask of a mission on the command line, and what they get.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fusion_node/query_server.h"
#include "operator_console/asking.h"
#include "operator_console/ply.h"
#include "operator_console/render.h"
#include "shoal/mapping/questions.h"
#include "tests/support/small_mission.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct Outcome {
  int exit_code = -1;
  std::string output;  // stdout; with what a shell says when 2>&1 stands in the command
};

Outcome shell(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer;
  for (size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    outcome.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  return outcome;
}

Outcome console(const std::string& arguments) {
  return shell("'" CONSOLE "' --log-level error " + arguments + " </dev/null");
}

class QuestionsTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = testing::TempDir() + "questions_XXXXXX";
    folder_ = mkdtemp(pattern.data());
    SmallMission::write(folder_);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  static std::string run() { return " --run " + folder_; }
  static std::string log() { return " --log " + folder_ + "/mission.lcmlog"; }
  static Json ask(const std::string& arguments) {
    const Outcome outcome = console(arguments + " --json");
    EXPECT_EQ(outcome.exit_code, 0) << arguments;
    return Json::parse(outcome.output, nullptr, false);
  }
  static void expectExit(int code, const std::string& arguments, const std::string& said) {
    const Outcome outcome = console(arguments + " 2>&1");
    EXPECT_EQ(outcome.exit_code, code) << arguments;
    EXPECT_NE(outcome.output.find(said), std::string::npos) << arguments << "\nsaid: " << outcome.output;
  }

  static std::string folder_;
};
std::string QuestionsTest::folder_;

TEST_F(QuestionsTest, RunAndRecordingAndNodeAnswerAlike) {
  const fusion_node::MissionState state = SmallMission::state();
  const mapping::MissionView view = state.view();
  const std::string socket_folder = folder_ + "/state";
  fusion_node::QueryServer server(socket_folder, [&](const Json& question) {
    return mapping::answer(
        {view, [&]() -> const mapping::BeliefStore& { return state.beliefs(); }, state.matcher()}, question);
  });
  std::jthread serving([&server](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      server.poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  for (const std::string question :
       {"status", "labels", "area 4", "why 4", "why 20006", "node R02", "at -2 -0.9"}) {
    const Json of_run = ask(question + run());
    EXPECT_EQ(of_run, ask(question + log())) << question;
    EXPECT_EQ(of_run, ask(question + " --node " + socket_folder)) << question;
  }
  expectExit(1, "area 99 --node " + socket_folder, "no label \"99\"; the largest are 4");
}

// R01 is not heard any more while R00 flies on; nobody is missed in what has ended.
TEST_F(QuestionsTest, WhoIsLostIsSilent) {
  fusion_node::MissionState state(SmallMission::kMission, matching::usualMatcher());
  comms::Stats stats;
  const auto hear = [&](const char* robot, int64_t at_s, wire::Phase phase) {
    wire::Heartbeat h;
    h.mission = SmallMission::kMission;
    h.time = {at_s * SmallMission::kSecond};
    h.phase = phase;
    h.budget = 2000;
    state.hear({comms::channelName(robot, "HEARTBEAT"), wire::encode(h)}, stats);
  };
  hear("R00", 10, wire::Phase::kFlying);
  hear("R01", 10, wire::Phase::kFlying);
  hear("R02", 10, wire::Phase::kLeaving);
  const std::string folder = folder_ + "/lost", node = " --node " + folder;
  std::mutex mutex;
  fusion_node::QueryServer server(folder, [&](const Json& question) {
    const std::scoped_lock lock(mutex);
    return mapping::answer({state.view(), [&]() -> const mapping::BeliefStore& { return state.beliefs(); },
                            state.matcher(), [&] { return state.events(); }},
                           question);
  });
  std::jthread serving([&server](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      server.poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const auto pass = [&](double wall_s) {
    const std::scoped_lock lock(mutex);
    state.passTime(wall_s);
    hear("R00", static_cast<int64_t>(wall_s) + 10, wire::Phase::kFlying);
  };
  const auto silent = [&] {
    std::string names;
    const Json answer = ask("status" + node);
    for (const Json& n : answer["nodes"])
      if (n["silent"] == true) names += n["name"].get<std::string>() + " ";
    return names;
  };
  pass(9);
  EXPECT_EQ(silent(), "");
  pass(20);
  EXPECT_EQ(silent(), "R01 ");
  const Json lost = ask("status" + node)["nodes"][1];
  EXPECT_EQ(lost["phase"], "flying");
  EXPECT_EQ(lost["ago_s"], 20.0);
  EXPECT_EQ(ask("node R01" + node)["node"], lost);
  EXPECT_NE(console("status" + node).output.find("R01      silent       20 "), std::string::npos)
      << console("status" + node).output;
  EXPECT_NE(console("node R01" + node).output.find("R01: silent, last flying, heard at 10.0 s, 20.0 s ago"),
            std::string::npos);
  {
    const std::scoped_lock lock(mutex);
    hear("R01", 29, wire::Phase::kFlying);
  }
  EXPECT_EQ(silent(), "");
  for (const std::string& where : {run(), log()}) {
    const Json ended = ask("status" + where);
    for (const Json& n : ended["nodes"]) EXPECT_EQ(n["silent"], false) << n;
    EXPECT_EQ(ended["nodes"][0]["ago_s"], 20.0);
  }
}

TEST_F(QuestionsTest, TablesFitEightyColumns) {
  for (const std::string question :
       {"status", "status --where", "labels", "area 4", "why 4", "node R00", "at -2 0", "diff 10 30"}) {
    const Outcome outcome = console(question + run());
    EXPECT_EQ(outcome.exit_code, 0) << question;
    std::istringstream lines(outcome.output);
    int num_lines = 0;
    for (std::string line; std::getline(lines, line); ++num_lines) EXPECT_LE(line.size(), 80u) << line;
    EXPECT_GT(num_lines, 1) << question;
    EXPECT_EQ(outcome.output.find('\033'), std::string::npos) << "colours belong on a terminal";
  }
}

TEST_F(QuestionsTest, AreaComesInEveryForm) {
  const Json area = ask("area 4" + run());
  EXPECT_EQ(area["area_m2"], 8.0);
  EXPECT_EQ(area["patches"][0]["box_m"], Json::parse("[-5.0, -1.0, -1.0, 1.0]"));
  EXPECT_EQ(console("area 4 --csv" + run()).output.substr(0, 11), "label,name,");
  const Json geojson = Json::parse(console("area 4 --geojson" + run()).output);
  EXPECT_EQ(geojson["features"][0]["geometry"]["coordinates"], area["patches"][0]["outline_m"][0]);
  EXPECT_EQ(ask("area 4 --since 0:10" + run())["area_m2"], 4.0);
  EXPECT_EQ(ask("area 4 --since 18 --certainty 1 --min-m2 4" + run())["patches"].size(), 1u);
  EXPECT_EQ(ask("area 4 --min-m2 9" + run())["patches"].size(), 0u);
}

TEST_F(QuestionsTest, WhatIsWrongIsNamed) {
  expectExit(1, "area 99" + run(), "no label \"99\"; the largest are 4");
  expectExit(1, "why nothing" + log(), "no label \"nothing\"");
  expectExit(1, "node R77" + run(), "heard were R00 R01 R02");
  expectExit(2, "area 4 --since 10:61" + run(), "\"10:61\"");
  expectExit(2, "area 4 --since -3" + run(), "\"-3\"");
  expectExit(2, "area 4 --certainty 1.5" + run(), "1.5");
  expectExit(2, "area 4 --min-m2 -1" + run(), "-1");
  expectExit(2, "area 4 --csv --geojson" + run(), "--csv");
  expectExit(2, "area 4 --csv --json" + run(), "--csv");
  expectExit(2, "area" + run(), "label");
  expectExit(2, "area 4", "[--node,--run,--log] is required");
  expectExit(2, "diff 30 10" + log(), "the earlier to the later");
  expectExit(1, "diff 10 30 --node " + folder_, "holds no mission that a node has heard");
  expectExit(2, "status --watch" + run(), "a finished run does not change");
  expectExit(2, "export --format gif --out x" + run(), "gif");
  expectExit(2, "serve", "[--node,--run,--log] is required");
}

// What is decided about a run and about its recording: the same file, the same map; of another log a file
// beside it.
TEST_F(QuestionsTest, DecisionsAboutAFinishedMissionAreKeptBesideIt) {
  const std::string folder = folder_ + "/judged", run = " --run " + folder,
                    log = " --log " + folder + "/mission.lcmlog";
  SmallMission::write(folder);
  const std::string map = mapping::readFile(folder + "/global_map.csv");
  const auto exported = [&](const std::string& where) {
    EXPECT_EQ(console("export --format csv --out " + folder + "/export.csv" + where).exit_code, 0);
    return mapping::readFile(folder + "/export.csv");
  };
  EXPECT_EQ(ask("name 4 \"brain coral\"" + run)["id"], "CONSOLE/1");
  EXPECT_EQ(ask("area \"brain coral\"" + log)["label"], 4);
  EXPECT_EQ(ask("labels" + run), ask("labels" + log));
  EXPECT_EQ(ask("exclude R01" + log)["id"], "CONSOLE/2");
  const std::string without = exported(run);
  EXPECT_EQ(without.find("R01"), std::string::npos);
  EXPECT_EQ(without, exported(log));
  EXPECT_EQ(console("undo" + run).output, "CONSOLE/3: CONSOLE/2 is undone\n");
  EXPECT_EQ(exported(run), map);
  EXPECT_EQ(exported(log), map);
  EXPECT_EQ(ask("edits" + run), ask("edits" + log));
  // 20006 is a label of its own; linked to 4, which is younger, it takes that in, and `why` says who wanted
  // it so.
  ask("link 4 20006" + run);
  EXPECT_EQ(ask("labels" + log)["labels"].size(), 2u);
  EXPECT_EQ(ask("why 20006" + run)["decided"], Json::array({"CONSOLE/4: 4 and 20006 are the same"}));
  EXPECT_EQ(ask("why 20006" + run), ask("why 20006" + log));
  ask("undo" + run);
  EXPECT_EQ(exported(run), map);
  ask("unlink 4 10005" + log);  // they look the same
  EXPECT_EQ(ask("labels" + run)["labels"].size(), 4u);
  ask("undo" + log);
  expectExit(1, "undo CONSOLE/2" + run, "undone already");
  expectExit(1, "exclude R07" + log, "heard were R00 R01 R02");
  expectExit(1, "link 4 4" + run, "twice");
  std::filesystem::rename(folder + "/mission.lcmlog", folder + "/other.lcmlog");
  EXPECT_EQ(ask("edits --log " + folder + "/other.lcmlog")["edits"].size(), 0u);
  mapping::writeFileAtomically(folder + "/edits.json", "{");
  expectExit(1, "labels" + run, folder + "/edits.json: ");
}

// At 10 s only R00 had spoken; at 30 s R01's later look had the shared column, and R02 a cell of its own.
TEST_F(QuestionsTest, DiffTellsWhatWasHeldThen) {
  const Json diff = ask("diff 10 0:30" + log());
  EXPECT_EQ(diff, ask("diff 10 0:30" + run()));
  EXPECT_EQ(diff["cells_before"], 3);
  EXPECT_EQ(diff["cells_after"], 4);
  EXPECT_EQ(diff["total"], Json::parse(R"({"appeared": 1, "seen": 0, "relabelled": 0, "gone": 0})"));
  EXPECT_EQ(diff["changes"][0]["after"], 20006);
  EXPECT_EQ(console("diff 10 30 --csv" + log()).output,
            "x_m,y_m,z_m,change,before,after,robot,seen_s\n"
            "18.000,0.000,0.000,appeared,,20006,R02,15.000\n");
  EXPECT_EQ(ask("diff 0 9.9" + log())["cells_after"], 0);
}

TEST_F(QuestionsTest, WatchingEndsWhenNobodyReads) {
  const Outcome outcome =
      shell("'" CONSOLE "' status --watch --every 0.1 --json" + log() + " 2>&1 </dev/null | head -n 2");
  std::istringstream lines(outcome.output);
  for (int look = 0; look < 2; ++look) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(Json::parse(line)["cells"], 4);
  }
}

// Lines are whole where no terminal ends them, and have no blanks at their ends.
TEST_F(QuestionsTest, NothingIsCutInPipes) {
  const std::string folder = folder_ + "/whole", run = " --run " + folder;
  SmallMission::write(folder);
  const std::string name = "a very long name for a label, longer than any table is wide";
  ask("name 4 \"" + name + "\"" + run);
  for (const std::string question : {"edits", "events"}) {
    const std::string said = console(question + run).output;
    EXPECT_NE(said.find(name), std::string::npos) << said;
    EXPECT_EQ(said.find(" \n"), std::string::npos) << said;
  }
}

TEST_F(QuestionsTest, SaysThatSealsWereNotChecked) {
  const std::string path = folder_ + "/sealed.lcmlog";
  SmallMission::writeSealedLog(path);
  const std::string said = shell("'" CONSOLE "' labels --log " + path + " 2>&1 >/dev/null </dev/null").output;
  EXPECT_NE(said.find(path + ": seals: "), std::string::npos) << said;
  EXPECT_NE(said.find("NOT checked: give --key"), std::string::npos) << said;
  EXPECT_EQ(shell("'" CONSOLE "' labels" + log() + " 2>&1 >/dev/null </dev/null").output, "");
}

TEST_F(QuestionsTest, ALegendIsCountedInLabels) {
  const std::string out = folder_ + "/legend.csv";
  EXPECT_EQ(console("export --format labels --out " + out + run()).output,
            "3 labels written to " + out + "\n");
}

TEST_F(QuestionsTest, ExportsGeoJsonOfAllLabels) {
  const std::string out = folder_ + "/map.geojson";
  EXPECT_EQ(console("export --format geojson --out " + out + run()).exit_code, 0);
  EXPECT_EQ(Json::parse(mapping::readFile(out))["features"].size(), 3u);
}

double littleEndianDouble(const std::string& bytes, size_t offset) {
  uint64_t value = 0;
  for (size_t i = 8; i-- > 0;) value = value << 8 | static_cast<uint8_t>(bytes[offset + i]);
  return std::bit_cast<double>(value);
}

TEST_F(QuestionsTest, ExportsPlyWithAPointACell) {
  const std::string out = folder_ + "/map.ply";
  EXPECT_EQ(console("export --format ply --out " + out + run()).exit_code, 0);
  const std::string ply = mapping::readFile(out);
  EXPECT_NE(ply.find("\nelement vertex 4\n"), std::string::npos);
  const size_t body = ply.find("end_header\n") + std::strlen("end_header\n");
  constexpr size_t kPoint = 3 * 8 + 3 + 8 + 3 * 4;
  ASSERT_EQ(ply.size() - body, 4 * kPoint);
  EXPECT_EQ(littleEndianDouble(ply, body), -4.0);  // cell (-2, 0, 0) of 2 m
  const Rgb color = colorOf(world::GlobalLabel{4});
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(static_cast<uint8_t>(ply[body + 24 + i]), color[i]);
  EXPECT_EQ(littleEndianDouble(ply, body + 27), 4.0);
  EXPECT_EQ(littleEndianDouble(ply, body + 3 * kPoint), 18.0);
  EXPECT_EQ(littleEndianDouble(ply, body + 3 * kPoint + 27), 20006.0);
}

TEST(CompletionTest, CompletesCommandsFlagsAndValuesInBash) {
  const auto completed = [](const std::string& words, int at) {
    return shell("bash -c 'source <(\"" CONSOLE "\" completion bash); COMP_WORDS=(operator_console " + words +
                 "); COMP_CWORD=" + std::to_string(at) + "; _operator_console; echo ${COMPREPLY[@]}' 2>&1")
        .output;
  };
  EXPECT_EQ(completed("ar", 1), "area\n");
  EXPECT_EQ(completed("area --ge", 2), "--geojson\n");
  EXPECT_EQ(completed("area --no", 2), "--node\n");
  EXPECT_EQ(completed("area 4 --matcher cl", 4), "clear\n");
  EXPECT_EQ(completed("completion z", 2), "zsh\n");
  EXPECT_EQ(completed("area 4 --run ma", 4), "\n");  // the shell's own files
}

TEST(CompletionTest, NamesEveryBuiltCommandForZsh) {
  const std::string script = console("completion zsh").output;
  for (const char* command : {"launch", "status", "area", "why", "diff", "node", "export", "name", "spy",
                              "doctor", "serve", "events"})
    EXPECT_NE(script.find("'" + std::string(command) + ":"), std::string::npos) << command;
  EXPECT_EQ(script.rfind("#compdef operator_console\n", 0), 0u);
  EXPECT_EQ(console("completion fish 2>&1").exit_code, 2);
}

TEST(MissionTimeTest, ReadsSecondsAndClocks) {
  EXPECT_DOUBLE_EQ(parseMissionTime("620"), 620);
  EXPECT_DOUBLE_EQ(parseMissionTime("0.5"), 0.5);
  EXPECT_DOUBLE_EQ(parseMissionTime("10:20"), 620);
  EXPECT_DOUBLE_EQ(parseMissionTime("1:10:20.5"), 4220.5);
  EXPECT_DOUBLE_EQ(parseMissionTime("90:00"), 5400);
  EXPECT_DOUBLE_EQ(parseMissionTime("1305031102.175304"), 1305031102.175304);  // a recording's own stamps
  for (const char* bad :
       {"", ":", "10:", ":20", "10:60", "10.5:20", "1:2:3:4", "-1", "1e3", "ten", "nan", "inf", "1:-2"})
    EXPECT_THROW(parseMissionTime(bad), std::invalid_argument) << bad;
}

}  // namespace
}  // namespace shoal::console
