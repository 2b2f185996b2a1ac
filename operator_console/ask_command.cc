// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "fusion_node/picture_files.h"
#include "fusion_node/query_server.h"
#include "operator_console/command.h"
#include "operator_console/stop_signal.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/number_check.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct Wish {
  std::vector<std::string> what;
  std::string node, out;
  int number = -1;
  double wait_s = 0;
  bool dry_run = false, json = false;
};

Json questionOf(const Wish& wish) {
  Json question{{"query", "ask"}};
  if (wish.number >= 0) question["example"] = wish.number;
  if (wish.what.size() == 1) {
    question["label"] = wish.what[0];
    return question;
  }
  const bool is_example = wish.what.size() == 3 && wish.what[1] == "example";
  size_t used = 0;
  int topic = -1;
  try {
    if (is_example) topic = std::stoi(wish.what[2], &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (!is_example || used != wish.what[2].size() || topic < 0) {
    throw std::invalid_argument(
        "ask for a label (ask 10004, ask \"brain coral\") or for the picture of a robot's "
        "topic (ask R03 example 7)");
  }
  question["robot"] = wish.what[0];
  question["topic"] = topic;
  return question;
}

Json answerOf(const Wish& wish, const Json& question) {
  Json answer = fusion_node::askNode(wish.node, question);
  if (answer.contains("error")) throw std::runtime_error(answer.at("error").get<std::string>());
  return answer;
}

mapping::HeldPicture pictureIn(const Json& answer) {
  const Json label = answer["label"].is_null() ? Json(0) : answer["label"];
  const Json one{{"labels", {{{"label", label}, {"pictures", {answer["picture"]}}}}}};
  return mapping::picturesFrom(one).begin()->second.at(0);
}

void writePicture(const std::string& path, const Json& answer) {
  constexpr double kEnlarged = 8;
  cv::Mat pixels = fusion_node::pixelsOf(pictureIn(answer));
  cv::resize(pixels, pixels, {}, kEnlarged, kEnlarged, cv::INTER_CUBIC);
  std::vector<uint8_t> bytes;
  cv::imencode(".png", pixels, bytes);
  mapping::writeFileAtomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string topicText(const Json& a) {
  return fmt::format("{} example {}", a["robot"].get<std::string>(), a["topic"].get<int>());
}

void printPrice(const Json& a) {
  if (a["state"] == "sharp") {
    fmt::print("{} is sharp already: nothing to pay\n", topicText(a));
    return;
  }
  const int64_t request = a["bytes"]["request"], reply = a["bytes"]["answer"];
  fmt::print("{}: at most {:.1f} kB ({} B to ask, {} B to answer)", topicText(a),
             static_cast<double>(request + reply) / 1000, request, reply);
  if (a["heard_ago_s"].is_null()) {
    fmt::print("; {} was never heard, so nobody knows when\n", a["robot"].get<std::string>());
    return;
  }
  if (a["seconds"].is_null()) {
    fmt::print("; no bound on when: {} has more to see or to learn, which takes most of its budget",
               a["robot"].get<std::string>());
  } else {
    fmt::print(", {:.0f} s", std::ceil(a["seconds"].get<double>()));
  }
  if (const double ago_s = a["heard_ago_s"]; ago_s > 60) fmt::print("; last heard {:.0f} s ago", ago_s);
  fmt::print("\n");
}

int ask(const Wish& wish) {
  Json question = questionOf(wish);
  question["dry_run"] = true;
  Json answer = answerOf(wish, question);
  if (!wish.json) printPrice(answer);
  if (!wish.dry_run && answer["state"] != "sharp") {
    catchStopSignals();
    question["dry_run"] = false;
    const auto until = Clock::now() + std::chrono::duration<double>(wish.wait_s);
    answer = answerOf(wish, question);
    while (answer["state"] != "sharp" && Clock::now() < until && stopSignal() == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      answer = answerOf(wish, question);  // asks again when the first askings were in vain
    }
    if (!wish.json) {
      fmt::print("{}\n", answer["state"] == "sharp" ? "it has come" : "asked; it comes when the link allows");
    }
  }
  if (!wish.out.empty()) {
    writePicture(wish.out, answer);
    if (!wish.json)
      fmt::print("{} written, {}\n", wish.out, answer["state"] == "sharp" ? "sharp" : "not sharp yet");
  }
  if (wish.json) std::cout << answer.dump(2) << '\n';
  const bool is_late = !wish.dry_run && wish.wait_s > 0 && answer["state"] != "sharp";
  return is_late ? 1 : 0;
}

}  // namespace

void addAskCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("ask", "a sharper picture from a robot; says first what it costs");
  const auto wish = std::make_shared<Wish>();
  command->add_option("what", wish->what, "a label, or: R03 example 7 (the picture of its topic 7)")
      ->required()
      ->expected(1, 3);
  command->add_option("--node", wish->node, "state folder of a running fusion_node")->required();
  command->add_option("--number", wish->number, "which picture of the topic, from 0")
      ->check(CLI::Range(0, 3));
  command->add_flag("--dry-run", wish->dry_run, "only say what it would cost; sends nothing");
  command
      ->add_option("--wait", wish->wait_s, "seconds of wall time to wait for it; exit 1 when it has not come")
      ->check(zeroOrMore);
  command->add_option("--out", wish->out, "PNG file for the picture as it is then held");
  command->add_flag("--json", wish->json, "answer in JSON");
  command->footer(
      "The price is an upper bound, and its seconds are mission time on a link that loses nothing: the "
      "request,\n"
      "what the robot has still to say, the answer. While a robot flies, or has yet to look again at its\n"
      "map, they have no bound (null in JSON): what is new takes most of its budget. All nodes get to hold\n"
      "what one has asked for.\n\n"
      "  operator_console ask R03 example 7 --node state --dry-run\n"
      "  operator_console ask 10004 --node state --wait 30 --out coral.png");
  command->callback([wish, &chosen] { chosen = [wish] { return ask(*wish); }; });
}

}  // namespace shoal::console
