// SPDX-License-Identifier: BSD-3-Clause
// The mission summary as a page: calm, printable, offline.
#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/picture_files.h"
#include "operator_console/render.h"
#include "operator_console/summary.h"
#include "operator_console/xml_text.h"
#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRareShare = 0.01;  // of the area

constexpr std::string_view kStyle = R"(
body { font: 15px/1.5 system-ui, sans-serif; color: #1b2733; background: #fbfcfd; max-width: 64rem; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; } h2 { font-size: 1.15rem; margin-top: 2.4rem; border-bottom: 1px solid #d5dde5; padding-bottom: .3rem; }
.note { color: #52616f; } .good { color: #1d6b3c; } .bad { color: #a3271c; font-weight: 600; }
dl.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(7.5rem, 1fr)); gap: .8rem; margin: 1.2rem 0; }
dl.facts div { background: #fff; border: 1px solid #e1e7ed; border-radius: 6px; padding: .5rem .8rem; }
dt { color: #52616f; font-size: .8rem; } dd { margin: 0; font-size: 1.15rem; font-weight: 600; }
img.map { max-width: 100%; border: 1px solid #d5dde5; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); gap: .9rem; }
.card { background: #fff; border: 1px solid #e1e7ed; border-radius: 6px; padding: .7rem .8rem; break-inside: avoid; }
.card h3 { font-size: 1rem; margin: 0 0 .4rem; display: flex; align-items: center; gap: .5rem; }
.swatch { width: 1rem; height: 1rem; border-radius: 3px; border: 1px solid #0003; display: inline-block; }
.shots { display: grid; grid-template-columns: repeat(4, 1fr); gap: 4px; margin-bottom: .4rem; } .shots .note { grid-column: 1 / -1; }
.shots img { width: 100%; border-radius: 3px; } .card p { margin: .1rem 0; font-size: .88rem; }
table { border-collapse: collapse; margin: .8rem 0; width: 100%; font-size: .9rem; }
th, td { padding: .25rem .6rem; text-align: right; border-bottom: 1px solid #e4e9ee; } th:first-child, td:first-child { text-align: left; }
th { font-weight: 600; color: #52616f; } .bar { display: flex; height: .8rem; width: 14rem; background: #edf1f4; }
.bar i { display: block; height: 100%; } .key i { display: inline-block; width: .8rem; height: .8rem; margin: 0 .3rem 0 .9rem; }
@media print { body { background: #fff; margin: 0; max-width: none; font-size: 12px; } h2 { break-after: avoid; } tr { break-inside: avoid; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
)";

// Colours that the colour-blind tell apart (Okabe and Ito 2008), by what summary.json calls the classes of
// traffic; what stays on its own host (local) is not on the link.
struct TrafficColor {
  std::string_view name, color;
};
constexpr std::array<TrafficColor, 7> kTraffic = {{{"heartbeat", "#999999"},
                                                   {"matches", "#cc79a7"},
                                                   {"topics", "#d55e00"},
                                                   {"bricks", "#0072b2"},
                                                   {"certainty", "#56b4e9"},
                                                   {"pictures", "#009e73"},
                                                   {"repair", "#e69f00"}}};

std::string base64(std::string_view bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kLetters[group >> (18 - 6 * k) & 63];
  }
  return text;
}

std::string image(const std::string& png, std::string_view kind, const std::string& alt) {
  return fmt::format("<img{} alt=\"{}\" title=\"{}\" src=\"data:image/png;base64,{}\">", kind, alt, alt,
                     base64(png));
}

std::string fact(std::string_view what, const std::string& value, std::string_view kind = "") {
  return fmt::format("<div><dt>{}</dt><dd class=\"{}\">{}</dd></div>\n", what, kind, value);
}

std::string titleOf(const Json& row) {
  const std::string name = row.at("name");
  return name.empty() ? "label " + std::to_string(row.at("label").get<int>()) : xmlText(name);
}

std::string finderOf(const Json& row) {
  const auto finder = world::name(world::RobotId{row.at("label").get<int32_t>() / 10000});
  return fmt::format("found by {} at {:.0f} s", finder, row.at("first_seen_s").get<double>());
}

std::string facts(const MissionSummary& mission) {
  const Json& f = mission.facts;
  const bool agreed = f.at("converged");
  const bool kept = f.at("worst_window").at("within_budget");
  std::string text = "<dl class=\"facts\">\n";
  text += fact("robots", std::to_string(f.at("robots").size()));
  text += fact("labels", std::to_string(mission.labels.size()));
  text += fact("area", fmt::format("{:.0f} m&sup2;", mission.area_m2));
  text += fact("coverage", fmt::format("{:.1f} %", 100 * f.at("coverage").get<double>()));
  text +=
      fact("nodes agree", agreed ? fmt::format("after {:.0f} s", f.at("converged_s").get<double>()) : "no",
           agreed ? "good" : "bad");
  text += fact("budget", kept ? "kept" : "exceeded", kept ? "good" : "bad");
  if (mission.verified) {
    const bool good = mission.verified->at("good");
    text += fact("recording", good ? "verified" : "not in order", good ? "good" : "bad");
  }
  return text + "</dl>\n";
}

std::string card(const MissionSummary& mission, const Json& row) {
  const world::GlobalLabel label{row.at("label").get<int32_t>()};
  const Rgb color = colorOf(label);
  std::string text = fmt::format(
      "<div class=\"card\"><h3><span class=\"swatch\" style=\"background:rgb({},{},{})\"></span>{}</h3>",
      color[0], color[1], color[2], titleOf(row));
  const auto held = mission.pictures.find(label);
  text += "<div class=\"shots\">";
  if (held == mission.pictures.end()) {
    text += "<span class=\"note\">no picture</span>";
  } else {
    for (const mapping::HeldPicture& p : held->second) {
      text += image(encodePng(fusion_node::pixelsOf(p)), "",
                    fmt::format("{}, seen at {:.0f} s", world::name(p.robot), p.seen.seconds()));
    }
  }
  const double area = row.at("area_m2");
  const double share = mission.area_m2 > 0 ? 100 * area / mission.area_m2 : 0;
  text += fmt::format("</div><p><b>{:.1f} m&sup2;</b>, {} of the map</p><p>{}</p>", area,
                      share < 0.05 ? "less than 0.1 %" : fmt::format("{:.1f} %", share), finderOf(row));
  const size_t robots = row.at("robots").size();
  return text + fmt::format("<p class=\"note\">{} robot{}, certainty {:.2f}</p></div>\n", robots,
                            robots == 1 ? "" : "s", row.at("certainty").get<double>());
}

std::string labels(const MissionSummary& mission) {
  std::string text = "<h2>What was found</h2>\n<div class=\"cards\">\n";
  for (const Json& row : mission.labels) text += card(mission, row);
  text += "</div>\n<h2>Rare finds</h2>\n";
  std::string rare;
  for (const Json& row : mission.labels) {
    if (row.at("area_m2").get<double>() >= kRareShare * mission.area_m2) continue;
    rare += fmt::format("<li>{}: {:.1f} m&sup2;, {}</li>\n", titleOf(row), row.at("area_m2").get<double>(),
                        finderOf(row));
  }
  return text + (rare.empty() ? "<p class=\"note\">No label covers less than 1 % of the map.</p>\n"
                              : "<ul>" + rare + "</ul>\n");
}

std::string surprises(const MissionSummary& mission) {
  std::string text = "<h2>Surprises</h2>\n";
  if (mission.surprises.empty()) return text + "<p class=\"note\">Nothing stood out.</p>\n";
  text += "<table><tr><th>surprise</th><th>place, m</th><th>cells</th><th>label</th><th>seen</th></tr>\n";
  const size_t told = std::min<size_t>(mission.surprises.size(), 8);
  for (size_t i = 0; i < told; ++i) {
    const Json& p = mission.surprises[i];
    text += fmt::format(
        "<tr><td>{:.1f}</td><td>({:.1f}, {:.1f})</td><td>{}</td><td>{}</td><td>by {} at {:.0f} s</td></tr>\n",
        p.at("surprise").get<double>(), p.at("x_m").get<double>(), p.at("y_m").get<double>(),
        p.at("cells").get<int64_t>(), titleOf(p), p.at("robots").front().get<std::string>(),
        p.at("first_seen_s").get<double>());
  }
  return text + fmt::format(
                    "</table>\n<p class=\"note\">Where robots saw what they had not met: 1 is what one "
                    "cell in ten exceeds. {} places in all.</p>\n",
                    mission.surprises.size());
}

std::string link(const MissionSummary& mission) {
  const Json& f = mission.facts;
  std::string text = "<h2>The link</h2>\n";
  const Json& window = f.at("worst_window");
  const auto budget = window.at("budget").get<int64_t>();
  text += budget == 0
              ? "<p>No budget was set.</p>\n"
              : fmt::format(
                    "<p>Budget {} bytes per second and process, all headers counted. Worst window: {} sent "
                    "{} bytes in {:.1f} s "
                    "({:.0f} % of what it might).</p>\n",
                    budget, xmlText(window.at("robot").get<std::string>()), window.at("bytes").get<int64_t>(),
                    window.at("length_s").get<double>(),
                    100 * window.at("bytes").get<double>() /
                        std::max(1.0, static_cast<double>(budget) * window.at("length_s").get<double>()));
  text += "<p class=\"key note\">";
  for (const auto& [name, color] : kTraffic)
    text += fmt::format("<i style=\"background:{}\"></i>{}", color, name);
  text +=
      "</p>\n<table><tr><th>node</th><th>bytes</th><th style=\"text-align:left\">by "
      "class</th><th>images</th><th>cells</th>"
      "<th>topics</th><th>refused</th><th>conflicts</th></tr>\n";
  int64_t most = 1;
  const auto sum = [&](const Json& bytes) {
    int64_t total = 0;
    for (const auto& [name, count] : bytes.items()) total += name == "local" ? 0 : count.get<int64_t>();
    return total;
  };
  for (const auto& [node, bytes] : f.at("bytes").items()) most = std::max(most, sum(bytes));
  for (const Json& node : f.at("nodes")) {
    const Json bytes = f.at("bytes").value(node.at("name").get<std::string>(), Json::object());
    std::string bar;
    for (const auto& [name, color] : kTraffic) {
      const double share = 100 * bytes.value(std::string(name), 0.0) / static_cast<double>(most);
      if (share > 0) bar += fmt::format("<i style=\"width:{:.2f}%;background:{}\"></i>", share, color);
    }
    const bool flies = node.at("phase") != "node";
    const auto ofRobots = [flies](int count) {
      return flies ? std::to_string(count) : std::string("&ndash;");
    };
    text += fmt::format(
        "<tr><td>{}</td><td>{}</td><td><div class=\"bar\">{}</div></td><td>{}</td><td>{}</td><td>{}</td>"
        "<td>{}</td><td>{}</td></tr>\n",
        xmlText(node.at("name").get<std::string>()), sum(bytes), bar,
        ofRobots(node.at("observation").get<int>() + 1), node.at("cells").get<int>(),
        ofRobots(node.at("topics").get<int>()), node.at("rejected").get<int>(),
        node.at("conflicts").get<int>());
  }
  return text + "</table>\n";
}

std::string faults(const MissionSummary& mission) {
  std::string text = "<h2>Proof</h2>\n";
  if (!mission.verified)
    return text + "<p class=\"note\">The mission was not recorded, so nothing can be verified.</p>\n";
  const Json& v = *mission.verified;
  const auto line = [](bool good, const std::string& what) {
    return fmt::format("<li class=\"{}\">{}</li>\n", good ? "good" : "bad", what);
  };
  text += "<ul>\n";
  text += line(v.at("budget_kept"),
               v.at("budget_kept").get<bool>() ? "Every node kept its budget." : "A budget was exceeded.");
  const auto lost = v.at("bytes_not_recorded").get<int64_t>();
  text += line(v.at("gaps_repaired"),
               lost == 0 ? "Nothing that was sent is missing from the recording."
                         : fmt::format("{} bytes were not recorded when they were sent; {}.", lost,
                                       v.at("gaps_repaired").get<bool>() ? "what they held was said again"
                                                                         : "not all was said again"));
  text += line(v.at("digests_equal"), v.at("digests_equal").get<bool>()
                                          ? "All nodes ended with the same state and map."
                                          : "Nodes ended with different states or maps.");
  for (const Json& wrong : v.at("wrong")) text += line(false, xmlText(wrong.get<std::string>()));
  return text + "</ul>\n";
}

std::string scores(const MissionSummary& mission) {
  const Json matchers = mission.facts.at("scores").value("matchers", Json::object());
  if (matchers.empty()) return "";
  const std::string flown = mission.facts.at("matching").at("matcher");
  std::string text =
      "<h2>Against the truth</h2>\n<table><tr><th>matcher</th><th>AMI</th><th>labels</th></tr>\n";
  for (const auto& [name, score] : matchers.items()) {
    text += fmt::format("<tr><td>{}{}</td><td>{:.3f}</td><td>{}</td></tr>\n", xmlText(name),
                        name == flown ? " (flown)" : "", score.value("ami", 0.0), score.value("labels", 0));
  }
  text += "</table>\n";
  if (mission.truth_png.empty()) return text;
  return text +
         "<p class=\"note\">As it was flown, the truth beside it; labels have the colours of the classes "
         "that they meet most.</p>\n" +
         image(mission.truth_png, " class=\"map\"", "the fused map beside the truth") + "\n";
}

}  // namespace

std::string summaryHtml(const MissionSummary& mission) {
  const Json& f = mission.facts;
  const std::string world = xmlText(f.at("world").get<std::string>());
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\">\n<title>Shoal: mission {}</title>\n<style>{}</style></head><body>\n",
      f.at("mission_id").get<int64_t>(), kStyle);
  page += fmt::format(
      "<h1>Mission {}</h1>\n<p class=\"note\">{}, {} images a robot, link {}, seed {}, commit {}</p>\n",
      f.at("mission_id").get<int64_t>(), world, f.at("observations").get<int64_t>(),
      xmlText(f.at("link").get<std::string>()), f.at("seed").get<uint64_t>(),
      xmlText(f.at("commit").get<std::string>()));
  page += facts(mission);
  if (!mission.map_png.empty())
    page += "<h2>The map</h2>\n" + image(mission.map_png, " class=\"map\"", "the fused map") + "\n";
  return page + labels(mission) + surprises(mission) + link(mission) + faults(mission) + scores(mission) +
         "</body></html>\n";
}

}  // namespace shoal::console
