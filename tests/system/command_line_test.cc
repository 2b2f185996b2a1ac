// SPDX-License-Identifier: BSD-3-Clause
// What people type wrong, and what the programs say then.
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

struct Outcome {
  int exit_code = -1;
  std::string output;  // stdout and stderr
};

Outcome run(const std::string& program, const std::string& arguments) {
  const std::string command = "env -u SHOAL_LCM_URL '" + program + "' " + arguments + " 2>&1 </dev/null";
  std::FILE* pipe = popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer;
  for (size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    outcome.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  return outcome;
}

Outcome console(const std::string& arguments) { return run(CONSOLE, arguments); }

void expectRefusal(const std::string& arguments, const std::string& said) {
  const Outcome outcome = console(arguments);
  EXPECT_EQ(outcome.exit_code, 2) << arguments;
  EXPECT_NE(outcome.output.find(said), std::string::npos) << arguments << "\nsaid: " << outcome.output;
}

std::string temporaryFolder() {
  std::string pattern = testing::TempDir() + "console_XXXXXX";
  return mkdtemp(pattern.data());
}

TEST(ConsoleTest, SaysItsVersionWithTheCommit) {
  const Outcome outcome = console("--version");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.output.rfind("operator_console 0.", 0), 0u) << outcome.output;
  EXPECT_NE(outcome.output.find(" ("), std::string::npos);
}

TEST(ConsoleTest, HelpIsNoMistakeAndNothingIs) {
  EXPECT_EQ(console("--help").exit_code, 0);
  EXPECT_EQ(console("launch --help").exit_code, 0);
  EXPECT_EQ(console("").exit_code, 2);
  EXPECT_EQ(console("lunch").exit_code, 2);
  EXPECT_EQ(console("--log-level loud launch --world reef:sparse --out x").exit_code, 2);
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// Each command's help ends with examples, and each of these is understood: with one word more, that word is
// all that is wrong, or a file that the example names is not there.
TEST(ConsoleTest, EveryHelpHasAnExampleThatIsUnderstood) {
  std::vector<std::string> commands;
  bool in_commands = false;
  for (const std::string& line : linesOf(console("--help").output)) {
    if (in_commands && line.starts_with("  ") && line[2] != ' ')
      commands.push_back(line.substr(2, line.find(' ', 2) - 2));
    in_commands |= line == "Subcommands:";
  }
  ASSERT_GE(commands.size(), 30u);
  commands.insert(commands.end(), {"library save", "library show"});
  const std::string program = "operator_console ", wrong = "--a-word-too-many";
  int tried = 0;
  for (const std::string& command : commands) {
    int examples = 0;
    std::string help = console(command + " --help").output;
    for (size_t at; (at = help.find("\\\n")) != std::string::npos;)
      help.erase(at, 2);  // it goes on in the next line
    for (const std::string& line : linesOf(help)) {
      const size_t at = line.find(program);
      if (!line.starts_with("  ") || at == std::string::npos) continue;
      examples += line.compare(at, program.size() + command.size(), program + command) == 0 ? 1 : 0;
      const size_t begin = at + program.size();
      const std::string example = line.substr(begin, line.find_first_of(">|)", begin) - begin);
      const Outcome outcome = console(example + " " + wrong);
      EXPECT_EQ(outcome.exit_code, 2) << example;
      EXPECT_TRUE(outcome.output.starts_with("The following argument was not expected: " + wrong + "\n") ||
                  outcome.output.find("File does not exist: ") != std::string::npos)
          << example << "\n"
          << outcome.output;
      ++tried;
    }
    EXPECT_GE(examples, 1) << command;
  }
  EXPECT_GE(tried, 45);
}

TEST(LaunchTest, NamesTheOptionThatIsWrong) {
  const std::string launch = "launch --out " + temporaryFolder() + "/run ";
  const std::string fly = launch + "--world reef:sparse ";
  expectRefusal(launch, "--world is missing");
  expectRefusal("launch --world reef:sparse", "--out is missing");
  expectRefusal(fly + "--robots -1", "--robots must lie in 1 to 256, or be 0 (as many as there are), got -1");
  expectRefusal(fly + "--robots many", "many");
  expectRefusal(fly + "--observations -1", "--observations");
  expectRefusal(fly + "--budget -5", "--budget");
  expectRefusal(fly + "--rate fast", "\"fast\"");
  expectRefusal(fly + "--matcher nearest", "nearest");
  expectRefusal(fly + "--similarity looks", "looks");
  expectRefusal(fly + "--sigma 1.5", "1.5");
  expectRefusal(fly + "--cell-size-m -1", "--cell-size-m");
  expectRefusal(fly + "--frame-period-s 0", "--frame-period-s");
  expectRefusal(fly + "--lcm-url tcp://1.2.3.4", "udpm://");
  expectRefusal(fly + "--no-such-flag", "--no-such-flag");
  expectRefusal(launch + "--world reef:purple", "reef:purple");
  expectRefusal(launch + "--world /no/such/folder", "/no/such/folder");
}

// A heartbeat says it in 32 bits.
TEST(BudgetTest, IsRefusedByNameWhenNoHeartbeatCouldSayIt) {
  const std::string robot = BIN "/robot_agent", node = BIN "/fusion_node";
  for (const auto& [program, arguments] : {std::pair(robot, "--source reef:sparse --budget 2147483648"),
                                           {node, "--budget 2147483648"},
                                           {robot, "--source reef:sparse --budget -1"},
                                           {node, "--budget -1"}}) {
    const Outcome outcome = run(program, arguments);
    EXPECT_EQ(outcome.exit_code, 2) << program;
    EXPECT_NE(outcome.output.find("--budget"), std::string::npos) << outcome.output;
  }
  expectRefusal("launch --world reef:sparse --out " + temporaryFolder() + "/run --budget 2147483648",
                "--budget");
}

TEST(LaunchTest, RefusesProfilesThatDoNotExist) {
  const std::string fly = "launch --world reef:sparse --out " + temporaryFolder() + "/run ";
  expectRefusal(fly + "--profile finest", "--profile must be best or paper, got \"finest\"");
}

TEST(LaunchTest, NamesTheFieldOfALinkThatIsWrong) {
  const std::string folder = temporaryFolder();
  const std::string fly = "launch --world reef:sparse --out " + folder + "/run --link ";
  std::ofstream(folder + "/bay.json") << "{\"loss\": 2}";
  expectRefusal(fly + folder + "/bay.json", "bay.json: \"loss\" must lie in [0, 1], got 2");
  expectRefusal(fly + "string", "string is neither clean, mesh, acoustic or satellite nor a file");
}

TEST(LaunchTest, NamesTheLineOfAKillPlanThatIsWrong) {
  const std::string folder = temporaryFolder();
  const std::string plan = folder + "/plan.txt";
  const std::string fly = "launch --world reef:sparse --robots 2 --out " + folder + "/run --kill-plan ";
  expectRefusal(fly + plan, plan);
  const std::pair<const char*, const char*> cases[] = {
      {"# nothing\n\n3 R00 crash\n",
       ":3: \"3 R00 crash\" should be `t_s ROBOT kill`, `t_s ROBOT restart` or `t_s ROBOT anew`"},
      {"soon R00 kill\n", ":1: \"soon R00 kill\" should be"},
      {"-1 R00 kill\n", ":1: the time must lie in [0, 1000000] s"},
      {"3 OPERATOR kill\n", ":1: OPERATOR is none of this mission's robots, R00 to R01"},
      {"3 R02 kill\n5 R02 restart\n", ":1: R02 is none of"},
      {"3 R00 restart\n", ":1: R00 is restarted and was not killed before"},
      {"3 R00 kill\n2 R00 restart\n", ":2: R00's times must grow"},
      {"3 R00 kill\n4 R00 kill\n", ":2: R00 is killed twice without a restart between"},
      {"3 R00 kill\n", ":1: R00 is killed and never restarted"},
  };
  for (const auto& [text, said] : cases) {
    std::ofstream(plan) << text;
    expectRefusal(fly + plan, plan + said);
  }
}

TEST(LaunchTest, KeepsAFinishedMission) {
  const std::string folder = temporaryFolder();
  std::ofstream(folder + "/summary.json") << "{}";
  expectRefusal("launch --world reef:sparse --out " + folder, "--overwrite");
  EXPECT_TRUE(std::filesystem::exists(folder + "/summary.json"));
}

// What a crash left: the recording, decisions, what the node remembers.
TEST(LaunchTest, KeepsWhatIsLeftOfAMissionThatDidNotEnd) {
  const std::string launch = "launch --world reef:sparse --observations 1 --out ";
  for (const std::string name : {"mission.lcmlog", "edits.json", "state/mission-5.sqlite"}) {
    const std::string folder = temporaryFolder();
    std::filesystem::create_directories(folder + "/state");
    std::filesystem::create_directories(folder + "/logs");
    std::ofstream(folder + "/logs/OPERATOR.log") << "killed\n";
    std::ofstream(folder + "/" + name) << "x";
    const std::string ask = "labels --log " + folder + "/" + name;
    expectRefusal(launch + folder, "a mission that did not end (" + name + ")");
    expectRefusal(launch + folder, "add --overwrite");
    if (name != "edits.json") {
      expectRefusal(launch + folder, ask);
      EXPECT_NE(console("labels --run " + folder)
                    .output.find("it has no summary.json; what is left of it "
                                 "answers: operator_console " +
                                 ask),
                std::string::npos);
    }
    EXPECT_TRUE(std::filesystem::exists(folder + "/" + name));
  }
}

TEST(ConsoleTest, NamesTheWordThatIsNotKnownAndTheNearest) {
  expectRefusal("lables", "unknown command lables; did you mean labels?");
  expectRefusal("xyzzyplugh", "unknown command xyzzyplugh; --help lists them");
  expectRefusal("library shwo", "unknown command shwo; did you mean show?");
  expectRefusal("labels --rnu a", "unknown option --rnu; did you mean --run?");
  expectRefusal("labels", "[--node,--run,--log] is required");
}

TEST(ConsoleTest, SaysWhichNumbersAreGood) {
  expectRefusal("area 4 --run x --min-m2 -5", "--min-m2: must be 0 or more, got -5\n");
  expectRefusal("surprises --run x --most 0", "--most: must be more than 0, got 0\n");
  expectRefusal("score --node x --robots many", "must be 0 or more, got many\n");
}

TEST(ConsoleTest, NamesTheFileThatIsNoLibrary) {
  const std::string page = temporaryFolder() + "/a.html";
  std::ofstream(page) << "<!doctype html>";
  EXPECT_NE(console("library show " + page).output.find(page + " is no library: it should be JSON"),
            std::string::npos);
}

TEST(LaunchTest, HelpSaysWhatRobotsZeroMeansAndAllThatAPlanCanSay) {
  const std::string help = console("launch --help").output;
  EXPECT_NE(help.find("0 (the default): 12"), std::string::npos);
  EXPECT_NE(help.find("kill|restart|anew"), std::string::npos);
}

TEST(LaunchTest, ReadsFlagsFromMissionToml) {
  const std::string folder = temporaryFolder();
  const std::string launch = "launch --out " + folder + "/run --config " + folder + "/mission.toml";
  std::ofstream(folder + "/mission.toml") << "world = \"reef:sparse\"\nrobots = 999\ncheckpoint = \"x\"\n";
  expectRefusal(launch, "got 999");
  expectRefusal(launch + " --robots 998", "got 998");  // the command line beats the file
  std::ofstream(folder + "/mission.toml") << "[launch]\nworld = \"reef:sparse\"\nlink = \"string\"\n";
  expectRefusal(launch, "string is neither clean, mesh, acoustic or satellite nor a file");
  expectRefusal("launch --config " + folder + "/nothing.toml", "nothing.toml");
}

// One file serves all programs. Each of these ends at once, for another reason.
class MissionFileTest : public testing::Test {
 protected:
  struct Program {
    std::string path, help, ends;
  };
  const std::vector<Program> programs_{
      {BIN "/robot_agent", "--help", "--robot nobody --source reef:sparse"},
      {BIN "/fusion_node", "--help", "--node nobody"},
      {CONSOLE, "launch --help", "launch --out ''"},
  };
  const std::string file_ = temporaryFolder() + "/mission.toml";

  std::string saidBy(const Program& program, const std::string& keys) {
    std::ofstream(file_) << keys;
    const Outcome outcome = run(program.path, program.ends + " --config " + file_);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    return outcome.output;
  }
};

TEST_F(MissionFileTest, SaysWhatIsLikelyATypingError) {
  for (const Program& program : programs_) {
    EXPECT_NE(saidBy(program, "budegt = 500\nwindspeed = 3\n")
                  .find(file_ + ": nothing is known of \"budegt\"; did you mean \"budget\"?"),
              std::string::npos);
    EXPECT_EQ(saidBy(program, "[tune]\nbudegt = 500\n").find("nothing is known"), std::string::npos);
  }
  EXPECT_NE(saidBy(programs_.back(), "[launch]\nbudegt = 500\n").find("\"budegt\""), std::string::npos);
}

TEST_F(MissionFileTest, FlagsOfTheOtherProgramsAreNoTypingErrors) {
  const std::regex flag("--([a-z-]+)");
  std::map<std::string, std::set<std::string>> flags;
  for (const Program& program : programs_) {
    const std::string help = run(program.path, program.help).output;
    for (std::sregex_iterator it(help.begin(), help.end(), flag), end; it != end; ++it)
      flags[program.path].insert((*it)[1]);
    EXPECT_GT(flags[program.path].size(), 15u);
  }
  for (const Program& program : programs_) {
    std::string keys;
    for (const auto& [path, of_others] : flags)
      for (const std::string& name : of_others)
        if (!flags[program.path].contains(name)) keys += name + " = 1\n";
    const std::string said = saidBy(program, keys);
    EXPECT_EQ(said.find("nothing is known"), std::string::npos) << program.path << ": " << said;
  }
}

// --since is a flag of area, --single one of launch.
TEST_F(MissionFileTest, FlagsOfTheOtherCommandsAreNoTypingErrors) {
  std::ofstream(file_) << "single = true\nsnice = 3\nsincee = 3\n";
  const std::string said = console("area 4 --run nowhere --config " + file_).output;
  EXPECT_EQ(said.find("\"single\""), std::string::npos) << said;
  EXPECT_NE(said.find("\"sincee\"; did you mean \"since\"?"), std::string::npos) << said;
}

// Who opened it a second time would wait for ever.
TEST_F(MissionFileTest, APipeIsReadOnce) {
  const std::string pipe = temporaryFolder() + "/pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Outcome outcome =
      run("/bin/sh", "-c 'echo budget = 500 >" + pipe +
                         " & exec timeout 20 " BIN "/fusion_node --node nobody --config " + pipe + "'");
  EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
}

}  // namespace
