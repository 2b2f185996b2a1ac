// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/summary_page.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "operator_console/base64.h"
#include "operator_console/line_plot.h"
#include "operator_console/mission_sources.h"
#include "operator_console/render.h"
#include "operator_console/verify.h"
#include "shoal/mapping/area_answer.h"
#include "shoal/mapping/atomic_file.h"

namespace shoal::console {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kRareShare = 0.01;  // of the mapped ground
constexpr size_t kMaxRare = 8;

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{0}</title><style>
body{{font:15px/1.45 system-ui,sans-serif;color:#222;max-width:1100px;margin:1.5em auto;padding:0 1em}}
h1{{font-size:1.5em;margin:0}}h2{{font-size:1.1em;margin:1.8em 0 .4em;border-bottom:1px solid #ccc}}
img.map{{max-width:100%;height:auto}}table{{border-collapse:collapse}}td,th{{padding:.2em .8em .2em 0;text-align:left}}
td.n,th.n{{text-align:right;font-variant-numeric:tabular-nums}}tr+tr td{{border-top:1px solid #eee}}
.swatch{{display:inline-block;width:1.6em;height:1.1em;border:1px solid #555;vertical-align:middle}}
.crop{{width:48px;height:48px;image-rendering:pixelated;vertical-align:middle}}
.bar{{display:flex;width:340px;height:1.1em;background:#eee}}.bar i{{display:block;height:100%}}
.bad{{color:#a00;font-weight:600}}.good{{color:#060}}.dim{{color:#666}}
</style></head><body>
<h1>{0}</h1>
)";

// Traffic classes in colours that the colour-blind tell apart (Okabe and Ito).
constexpr const char* kClassColors[] = {"#0072b2", "#e69f00", "#009e73", "#56b4e9",
                                        "#cc79a7", "#d55e00", "#f0e442", "#999999"};

double number(const Json& json, const char* key) { return json.value(key, 0.0); }

Json asked(const std::string& dir, const Json& question) {
  const Json answer = ask({.node = {}, .run = dir, .log = {}, .matcher = matching::usualMatcher()}, question);
  if (answer.contains("error")) throw std::runtime_error(dir + ": " + answer.at("error").get<std::string>());
  return answer;
}

std::string image(const std::string& path, const char* kind, const std::string& what) {
  return fmt::format("<img class=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">", kind, escaped(what),
                     base64(mapping::readFile(path)));
}

// What the label looks like: a crop of the topic it is named after, when its robot kept one.
std::string cropOf(const std::string& dir, int label) {
  const std::string path = fmt::format("{}/robots/{}/pictures/{}.png", dir,
                                       world::name(world::RobotId{label / 10000}), label % 10000);
  return fs::exists(path) ? image(path, "crop", "example of " + std::to_string(label)) : "";
}

std::string titleOf(const Json& label) {
  const std::string name = label.at("name");
  return name.empty()
             ? std::to_string(label.at("label").get<int>())
             : escaped(name) + fmt::format(" <span class=\"dim\">{}</span>", label.at("label").get<int>());
}

std::string facts(const Json& s) {
  std::string text = fmt::format(
      "<p>{} robots, {} images each, link {}, {}. {} cells of {} m, {} labels", s.at("robots").size(),
      s.at("observations").get<int>(), escaped(s.value("link", "clean")),
      s.at("worst_window").at("budget").get<int64_t>() > 0
          ? fmt::format("{} bytes/s each", s.at("worst_window").at("budget").get<int64_t>())
          : "no budget",
      s.at("cells").get<int64_t>(), s.at("cell_size_m").get<double>(), s.at("labels").get<int64_t>());
  if (s.contains("coverage") && s.at("coverage").is_number()) {
    text += fmt::format(", {:.1f} % of the place", 100 * s.at("coverage").get<double>());
  }
  const bool converged = s.at("converged");
  return text + fmt::format(".<br><span class=\"{}\">{}</span>. Mission {}, seed {}, commit {}.</p>\n",
                            converged ? "good" : "bad",
                            converged
                                ? fmt::format("All nodes held one map at {:.1f} s", number(s, "converged_s"))
                                : "The nodes did not come to hold one map",
                            s.at("mission_id").get<int64_t>(), s.at("seed").get<uint64_t>(),
                            escaped(s.value("commit", "unknown")));
}

std::string labelTable(const std::string& dir, std::vector<Json> labels, double total_m2) {
  std::string html =
      "<h2>Labels</h2>\n<table><tr><th></th><th></th><th>label</th><th class=\"n\">area m²</th><th "
      "class=\"n\">share</th>"
      "<th class=\"n\">sure</th><th>found by</th><th class=\"n\">at s</th><th>robots</th></tr>\n";
  for (const Json& l : labels) {
    const int label = l.at("label");
    const Rgb c = colorOf(world::GlobalLabel{label});
    std::string robots;
    for (const Json& r : l.at("robots")) robots += (robots.empty() ? "" : " ") + r.get<std::string>();
    html += fmt::format(
        "<tr><td><span class=\"swatch\" "
        "style=\"background:#{:02x}{:02x}{:02x}\"></span></td><td>{}</td><td>{}</td>"
        "<td class=\"n\">{:.1f}</td><td class=\"n\">{:.1f} %</td><td class=\"n\">{:.2f}</td><td>{}</td><td "
        "class=\"n\">{:.1f}"
        "</td><td>{}</td></tr>\n",
        c[0], c[1], c[2], cropOf(dir, label), titleOf(l), number(l, "area_m2"),
        total_m2 > 0 ? 100 * number(l, "area_m2") / total_m2 : 0.0, number(l, "certainty"),
        world::name(world::RobotId{label / 10000}), number(l, "first_seen_s"), robots);
  }
  return html + "</table>\n";
}

std::string rareFinds(const std::string& dir, const std::vector<Json>& labels, double total_m2) {
  std::string rows;
  size_t told = 0;
  for (auto l = labels.rbegin(); l != labels.rend() && told < kMaxRare; ++l) {
    if (number(*l, "area_m2") >= kRareShare * total_m2) break;
    const Json area = asked(dir, {{"query", "area"}, {"label", std::to_string(l->at("label").get<int>())}});
    if (area.at("patches").empty()) continue;
    const Json& p = area.at("patches").at(0);
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"n\">{:.1f}</td><td class=\"n\">{}</td><td>({:.1f}, {:.1f})</td></tr>\n",
        titleOf(*l), number(*l, "area_m2"), area.at("patches").size(), p.at("centroid_m").at(0).get<double>(),
        p.at("centroid_m").at(1).get<double>());
    ++told;
  }
  if (rows.empty()) return "";
  return fmt::format("<h2>Rare finds</h2>\n<p>Labels on less than {:.0f} % of the mapped ground.</p>\n",
                     100 * kRareShare) +
         "<table><tr><th>label</th><th class=\"n\">area m²</th><th class=\"n\">patches</th><th>largest at X, "
         "Y m</th></tr>\n" +
         rows + "</table>\n";
}

std::string linkTable(const Json& s) {
  double most = 1;
  for (const auto& [node, classes] : s.at("bytes").items()) {
    double sum = 0;
    for (const auto& [name, bytes] : classes.items())
      if (name != "local") sum += bytes.get<double>();
    most = std::max(most, sum);
  }
  std::string
      html =
          "<h2>The link</h2>\n<table><tr><th>node</th><th class=\"n\">kB sent</th><th>by class</th></tr>\n",
      legend;
  for (const auto& [node, classes] : s.at("bytes").items()) {
    double sum = 0;
    std::string bar;
    size_t color = 0;
    legend.clear();
    for (const auto& [name, bytes] : classes.items()) {
      const char* shade = kClassColors[color++ % std::size(kClassColors)];
      if (name == "local") continue;  // stays on its own host
      sum += bytes.get<double>();
      bar += fmt::format("<i style=\"width:{:.2f}%;background:{}\" title=\"{} {} bytes\"></i>",
                         100 * bytes.get<double>() / most, shade, escaped(name), bytes.get<int64_t>());
      legend += fmt::format("<span class=\"swatch\" style=\"background:{}\"></span> {} &nbsp; ", shade,
                            escaped(name));
    }
    html +=
        fmt::format("<tr><td>{}</td><td class=\"n\">{:.1f}</td><td><div class=\"bar\">{}</div></td></tr>\n",
                    escaped(node), sum / 1000, bar);
  }
  const Json& w = s.at("worst_window");
  const bool within = w.value("within_budget", true);
  return html + "</table>\n<p>" + legend +
         fmt::format(
             "</p>\n<p class=\"{}\">Fullest window: {} sent {} bytes in {:.1f} s from {:.1f} s{}.</p>\n",
             within ? "" : "bad", escaped(w.value("robot", "")), w.at("bytes").get<int64_t>(),
             number(w, "length_s"), number(w, "start_s"),
             within ? ", within the budget" : ", ABOVE THE BUDGET");
}

std::string lines(const char* heading, const std::vector<std::string>& lines, const char* kind) {
  if (lines.empty()) return "";
  std::string html = fmt::format("<h2>{}</h2>\n<ul class=\"{}\">\n", heading, kind);
  for (const std::string& line : lines) html += "<li>" + escaped(line) + "</li>\n";
  return html + "</ul>\n";
}

std::string faults(const std::string& dir) {
  std::vector<std::string> went_wrong, decided;
  const Json events = asked(dir, {{"query", "events"}});
  for (const Json& e : events.at("events")) {
    const std::string kind = e.at("kind");
    if (kind == "label" || kind == "joined" || kind == "landed" || kind == "leaving") continue;
    (kind == "edit" ? decided : went_wrong)
        .push_back(fmt::format("{:.1f} s, {}: {}", number(e, "at_s"), e.at("node").get<std::string>(),
                               e.at("says").get<std::string>()));
  }
  return lines("Decided", decided, "") + lines("Faults", went_wrong, "bad");
}

std::string verdict(const std::string& dir) {
  const std::string recording = dir + "/mission.lcmlog";
  if (!fs::exists(recording))
    return "<h2>Verified</h2>\n<p>Not recorded: nothing to verify (launch --record).</p>\n";
  const Verification v = verify(recording);
  const auto wrong = v.wrong();
  if (!wrong.empty()) return lines("Verified: something was wrong", wrong, "bad");
  std::string text =
      "<h2>Verified</h2>\n<p class=\"good\">From the recording: budgets kept in every window, what the "
      "recorder "
      "missed was said again, all nodes hold what it adds up to";
  if (v.landed_s && v.agreed_s)
    text += fmt::format(", {:.1f} s after the last landing", *v.agreed_s - *v.landed_s);
  return text + ".</p>\n";
}

std::string scores(const Json& s) {
  if (!s.contains("scores") || !s.at("scores").contains("matchers")) return "";
  std::string html =
      "<h2>Against the truth</h2>\n<table><tr><th>matcher</th><th class=\"n\">AMI</th><th "
      "class=\"n\">labels</th></tr>\n";
  for (const auto& [matcher, score] : s.at("scores").at("matchers").items()) {
    html += fmt::format("<tr><td>{}</td><td class=\"n\">{:.3f}</td><td class=\"n\">{}</td></tr>\n",
                        escaped(matcher), number(score, "ami"), score.at("labels").get<int>());
  }
  return html + "</table>\n";
}

}  // namespace

std::string summaryPage(const std::string& dir) {
  const std::string path = dir + "/summary.json";
  if (!fs::exists(path)) throw std::runtime_error(dir + " is not a finished run: it has no summary.json");
  try {
    const Json s = Json::parse(mapping::readFile(path));
    const Json legend = asked(dir, {{"query", "labels"}});
    std::vector<Json> labels(legend.at("labels").begin(), legend.at("labels").end());
    std::ranges::stable_sort(labels, std::greater<>(), [](const Json& l) { return number(l, "area_m2"); });
    double total_m2 = 0;
    for (const Json& l : labels) total_m2 += number(l, "area_m2");
    const std::string title = "Mission over " + s.at("world").get<std::string>();
    std::string page = fmt::format(kHead, escaped(title)) + facts(s);
    const std::string map = dir + "/global_map.png";
    if (fs::exists(map)) page += image(map, "map", "the fused map with its legend") + "\n";
    return page + labelTable(dir, labels, total_m2) + rareFinds(dir, labels, total_m2) + faults(dir) +
           linkTable(s) + verdict(dir) + scores(s) + "</body></html>\n";
  } catch (const Json::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace shoal::console
