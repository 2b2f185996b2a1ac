// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/reproduce_report.h"

#include <cmath>
#include <functional>
#include <optional>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include "operator_console/bar.h"
#include "operator_console/base64.h"
#include "operator_console/line_plot.h"
#include "operator_console/xml_text.h"
#include "shoal/eval/statistics.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/rounded.h"
#include "shoal/version.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

// Table I of Jamieson et al. 2021: mean AMI and standard deviation with 12 robots.
struct Published {
  std::string_view row;
  double mean[2], deviation[2];  // environments 1 and 2
};
constexpr Published kPublished[] = {
    {"ID", {.117, .078}, {.035, .016}},
    {"Hungarian, l1", {.297, .216}, {.006, .004}},
    {"Hungarian, l2", {.313, .253}, {.016, .039}},
    {"Hungarian, cosine", {.304, .203}, {.011, .015}},
    {"CLEAR, overlap 0.75", {.250, .341}, {.002, .003}},
    {"CLEAR, cosine 0.75", {.384, .406}, {.006, .007}},
    {"one robot", {.344, .382}, {.026, .024}},
};

std::string published(const std::string& world, const std::string& row) {
  const int environment = world == "reef:sparse" ? 0 : world == "reef:varied" ? 1 : -1;
  if (environment < 0) return "";
  for (const Published& p : kPublished) {
    if (p.row == row) return fmt::format("{:.3f} ({:.3f})", p.mean[environment], p.deviation[environment]);
  }
  return "";
}

struct Row {
  std::string name;
  eval::Summary newest, concatenated, labels;
  std::optional<eval::Summary> ari, f1;  // of the topics, where they are matched
};

eval::Summary over(const WorldResult& world, const std::function<double(const eval::Repeat&)>& value) {
  std::vector<double> sample;
  for (const eval::Repeat& r : world.repeats) sample.push_back(value(r));
  return eval::summarize(sample);
}

std::vector<Row> rowsOf(const Reproduction& all, const WorldResult& world) {
  std::vector<Row> rows;
  for (size_t m = 0; m < all.matchers.size(); ++m) {
    rows.push_back({eval::nameOf(all.matchers[m]),
                    over(world, [m](const auto& r) { return r.newest[m].ami; }),
                    over(world, [m](const auto& r) { return r.concatenated[m].ami; }),
                    over(world, [m](const auto& r) { return static_cast<double>(r.newest[m].labels); }),
                    over(world, [m](const auto& r) { return r.matches[m].ari; }),
                    over(world, [m](const auto& r) { return r.matches[m].f1; })});
  }
  const auto alike = [&](const std::string& name,
                         const std::function<const eval::Score&(const eval::Repeat&)>& of) {
    const eval::Summary ami = over(world, [&](const auto& r) { return of(r).ami; });
    rows.push_back({name,
                    ami,
                    ami,
                    over(world, [&](const auto& r) { return static_cast<double>(of(r).labels); }),
                    {},
                    {}});
  };
  if (all.options.exchange_every > 0) {
    alike("merged models (Doherty 2018)", [](const auto& r) -> const eval::Score& { return r.merged; });
  }
  alike("one robot", [](const auto& r) -> const eval::Score& { return r.single; });
  alike("oracle matching", [](const auto& r) -> const eval::Score& { return r.oracle; });
  return rows;
}

std::string csvRow(const std::vector<std::string>& cells) {
  std::string row;
  for (size_t i = 0; i < cells.size(); ++i) {
    const bool quotes = cells[i].find_first_of(",\"\n") != std::string::npos;
    row += (i ? "," : "") + (quotes ? "\"" + cells[i] + "\"" : cells[i]);
  }
  return row + "\n";
}

std::string f(double value) { return fmt::format("{:.4f}", value); }

std::string tableCsv(const Reproduction& all) {
  std::string csv = "world,matcher,repeats,ami,deviation,margin95,ami_concatenated,labels,ari,f1,paper\n";
  for (const WorldResult& world : all.worlds) {
    for (const Row& row : rowsOf(all, world)) {
      csv += csvRow({world.world, row.name, std::to_string(row.newest.count), f(row.newest.mean),
                     f(row.newest.deviation), f(row.newest.margin), f(row.concatenated.mean),
                     fmt::format("{:.1f}", row.labels.mean), row.ari ? f(row.ari->mean) : "",
                     row.f1 ? f(row.f1->mean) : "", published(world.world, row.name)});
    }
  }
  return csv;
}

// Curves over robots or images, one a matcher and one for the robot that flies alone.
std::vector<Series> curves(const Reproduction& all, const WorldResult& world,
                           const std::function<const std::vector<eval::Point>&(const eval::Repeat&)>& points,
                           bool with_single) {
  std::vector<Series> series;
  const size_t length = points(world.repeats[0]).size();
  for (size_t m = 0; m <= all.matchers.size(); ++m) {
    const bool single = m == all.matchers.size();
    if (single && !with_single) break;
    Series s{.name = single ? "one robot" : eval::nameOf(all.matchers[m]),
             .x = {},
             .y = {},
             .margin = {},
             .dashed = single};
    for (size_t i = 0; i < length; ++i) {
      const eval::Summary ami =
          over(world, [&](const auto& r) { return single ? points(r)[i].single : points(r)[i].ami[m]; });
      s.x.push_back(points(world.repeats[0])[i].at);
      s.y.push_back(ami.mean);
      s.margin.push_back(ami.margin);
    }
    series.push_back(std::move(s));
  }
  return series;
}

std::vector<Series> byRobots(const Reproduction& all, const WorldResult& world) {
  return curves(
      all, world, [](const auto& r) -> const auto& { return r.by_robots; }, true);
}

std::vector<Series> byImages(const Reproduction& all, const WorldResult& world) {
  return curves(
      all, world, [](const auto& r) -> const auto& { return r.by_images; }, false);
}

std::vector<Series> byShares(const Reproduction& all, const WorldResult& world) {
  std::vector<Series> series;
  if (world.by_shares.empty()) return series;
  for (size_t m = 0; m < all.matchers.size(); ++m) {
    Series s{.name = eval::nameOf(all.matchers[m]), .x = {}, .y = {}, .margin = {}};
    for (const SharesResult& result : world.by_shares) {
      std::vector<double> sample;
      for (const auto& ami : result.ami) sample.push_back(ami[m]);
      const eval::Summary ami = eval::summarize(sample);
      s.x.push_back(result.shares);
      s.y.push_back(ami.mean);
      s.margin.push_back(ami.margin);
    }
    series.push_back(std::move(s));
  }
  const double alone = over(world, [](const auto& r) { return r.single.ami; }).mean;
  Series s{.name = "one robot", .x = {}, .y = {}, .margin = {}, .dashed = true};
  for (const SharesResult& result : world.by_shares) {
    s.x.push_back(result.shares);
    s.y.push_back(alone);
    s.margin.push_back(0);
  }
  series.push_back(std::move(s));
  return series;
}

std::string curvesCsv(const Reproduction& all, const std::string& what,
                      std::vector<Series> (*curves_of)(const Reproduction&, const WorldResult&)) {
  std::string csv = "world,matcher," + what + ",ami,margin95\n";
  for (const WorldResult& world : all.worlds) {
    for (const Series& s : curves_of(all, world)) {
      for (size_t i = 0; i < s.x.size(); ++i) {
        csv += csvRow({world.world, s.name, fmt::format("{:.0f}", s.x[i]), f(s.y[i]), f(s.margin[i])});
      }
    }
  }
  return csv;
}

// AMI over that of one robot, against the number of shares: does a team lose by being large?
std::optional<eval::Line> trend(const WorldResult& world, size_t matcher) {
  const double alone = over(world, [](const auto& r) { return r.single.ami; }).mean;
  if (world.by_shares.size() < 2 || alone <= 0) return std::nullopt;
  std::vector<double> x, y;
  for (const SharesResult& result : world.by_shares) {
    for (const auto& ami : result.ami) {
      x.push_back(result.shares);
      y.push_back(ami[matcher] / alone);
    }
  }
  return eval::fitLine(x, y);
}

constexpr std::string_view kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Shoal: the paper's experiments</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #1b2733; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; background: #fbfcfd; }
h1 { font-size: 1.6rem; } h2 { margin-top: 2.6rem; border-bottom: 1px solid #d5dde5; padding-bottom: .3rem; }
table { border-collapse: collapse; margin: 1rem 0; } th, td { padding: .25rem .8rem; text-align: right; border-bottom: 1px solid #e4e9ee; }
th:first-child, td:first-child { text-align: left; } th { font-weight: 600; } .best td { font-weight: 600; } .paper { color: #5b6b7a; }
svg { width: 100%; max-width: 46rem; display: block; margin: 1rem 0; font: 11px system-ui, sans-serif; fill: #1b2733; }
svg .title { font-size: 13px; font-weight: 600; } svg .grid { stroke: #e4e9ee; } svg polyline { fill: none; }
img { max-width: 100%; border: 1px solid #d5dde5; margin: .4rem 0 1rem; } code { background: #eef2f5; padding: 0 .25rem; }
.note { color: #435261; }
</style></head><body>
<h1>Multi-robot distributed semantic mapping: the paper's experiments</h1>
)";

constexpr std::string_view kDifferences = R"(<h2>What differs from the paper</h2>
<ul>
<li>The reefs are procedural stand-ins for the paper's two Unreal Engine environments, which are not public: another place with the
same plan (1: few species on uniform sand in light and shade; 2: other terrain and species in each quarter). Absolute AMI
can therefore not be compared with the paper's, only the order of the methods and the shape of the curves.</li>
<li>Robots refine their model by a fixed count of re-samples an image, not for 600 ms of wall time, so that runs repeat.</li>
<li>The vocabulary is our own: the paper's is not public.</li>
<li>Repeats differ by the random numbers of the models; the images are the same, as in the paper. Intervals are 95 % of the mean
(Student) over repeats and say nothing about other places.</li>
<li>&ldquo;Newest&rdquo; is the paper's fusion rule (the last visitor's label); &ldquo;all&rdquo; counts a cell once for each
robot that saw it, as the paper's own program does.</li>
</ul>
)";

std::string html(const Reproduction& all) {
  const ReproduceOptions& o = all.options;
  std::string page(kHead);
  page += fmt::format(
      "<p class=\"note\">{} robots, {} images each, {} repeats, profile {}, seed {}; Shoal {} ({}). After S. "
      "Jamieson, K. Fathian, "
      "K. Khosoussi, J. P. How, Y. Girdhar, ICRA 2021. AMI is adjusted mutual information with the truth, "
      "normalised by the larger "
      "entropy: 1 is a perfect map, 0 a random one. ARI and F1 are those of the topics, each taken for the "
      "class "
      "of most of its cells, cells left aside.</p>\n",
      o.num_robots, o.observations, o.repeats, xmlText(o.profile), o.seed, version(), commit());
  for (const WorldResult& world : all.worlds) {
    page += fmt::format(
        "<h2>{}</h2>\n<table><tr><th>matching</th><th>AMI, newest</th><th>deviation</th><th>95 "
        "%</th><th>AMI, all"
        "</th><th>labels</th><th>topics, ARI</th><th>F1</th><th class=\"paper\">paper</th></tr>\n",
        xmlText(world.world));
    const std::vector<Row> rows = rowsOf(all, world);
    double best = -1;
    for (size_t m = 0; m < all.matchers.size(); ++m) best = std::max(best, rows[m].newest.mean);
    for (size_t m = 0; m < rows.size(); ++m) {
      const Row& r = rows[m];
      page += fmt::format(
          "<tr{}><td>{}</td><td>{:.3f}</td><td>{:.3f}</td><td>± "
          "{:.3f}</td><td>{:.3f}</td><td>{:.1f}</td><td>{}</td><td>{}</td><td "
          "class=\"paper\">"
          "{}</td></tr>\n",
          m < all.matchers.size() && r.newest.mean == best ? " class=\"best\"" : "", xmlText(r.name),
          r.newest.mean, r.newest.deviation, r.newest.margin, r.concatenated.mean, r.labels.mean,
          r.ari ? fmt::format("{:.3f}", r.ari->mean) : "", r.f1 ? fmt::format("{:.3f}", r.f1->mean) : "",
          published(world.world, r.name));
    }
    const eval::Repeat& first = world.repeats[0];
    page += fmt::format(
        "</table>\n<p class=\"note\">{} cells of {:g} m with {} classes, {} images of {} robots. Robots' own "
        "topics are "
        "{:.1f} % pure. One robot sends {:.1f} kB of topics and "
        "{:.1f} kB of map without losses (changes after every fifth image, all headers counted, no "
        "heartbeats).",
        first.newest.empty() ? 0 : first.newest[0].cells, world.cell_size_m, world.classes, world.images,
        world.robots, 100 * over(world, [](const auto& r) { return r.purity; }).mean,
        first.topics_bytes / 1000, first.map_bytes / 1000);
    if (o.exchange_every > 0) {
      page += fmt::format(
          " Merging models every {} images, one robot sends {:.1f} kB of topics, which is all that matching "
          "at the "
          "same rhythm would need, and receives {:.1f} kB of merged models besides.",
          o.exchange_every, first.merged_sent / 1000, first.merged_received / 1000);
    }
    page += fmt::format(" {} of wall time.</p>\n", duration(world.seconds));
    page += svg({.title = "AMI against team size, random teams",
                 .x_name = "robots",
                 .y_name = "AMI",
                 .series = byRobots(all, world)});
    page += svg({.title = "AMI while exploring",
                 .x_name = "images per robot",
                 .y_name = "AMI",
                 .series = byImages(all, world)});
    if (!world.by_shares.empty()) {
      page += svg({.title = "The same area and number of images, shared among more robots",
                   .x_name = "robots",
                   .y_name = "AMI",
                   .series = byShares(all, world)});
      page += "<p class=\"note\">Slope of AMI over that of one robot, per 10 robots more:";
      for (size_t m = 0; m < all.matchers.size(); ++m) {
        if (const auto line = trend(world, m)) {
          page += fmt::format(" {} {:+.3f} ± {:.3f};", xmlText(eval::nameOf(all.matchers[m])),
                              10 * line->slope, 10 * line->slope_margin);
        }
      }
      page.back() = '.';
      page += "</p>\n";
    }
    for (const SampleMap& map : world.maps) {
      page += fmt::format("<img alt=\"map by {} beside the truth\" src=\"data:image/png;base64,{}\">\n",
                          xmlText(map.name), base64(map.png));
    }
  }
  page += kDifferences;
  return page + "</body></html>\n";
}

Json toJson(const eval::Summary& s) {
  return {{"mean", rounded(s.mean, 1e6)},
          {"deviation", rounded(s.deviation, 1e6)},
          {"margin95", rounded(s.margin, 1e6)}};
}

}  // namespace

Json summaryOf(const Reproduction& all) {
  const ReproduceOptions& o = all.options;
  Json json = {{"commit", commit()},     {"profile", o.profile},
               {"robots", o.num_robots}, {"observations", o.observations},
               {"repeats", o.repeats},   {"seed", o.seed},
               {"worlds", Json::array()}};
  for (const WorldResult& world : all.worlds) {
    Json rows = Json::array();
    for (const Row& row : rowsOf(all, world)) {
      rows.push_back({{"matcher", row.name},
                      {"ami", toJson(row.newest)},
                      {"ami_concatenated", toJson(row.concatenated)},
                      {"labels", rounded(row.labels.mean, 1e6)},
                      {"ari", row.ari ? toJson(*row.ari) : Json()},
                      {"f1", row.f1 ? toJson(*row.f1) : Json()},
                      {"paper", published(world.world, row.name)}});
    }
    const eval::Repeat& first = world.repeats[0];
    json["worlds"].push_back(
        {{"world", world.world},
         {"cells", first.newest[0].cells},
         {"scored", first.newest[0].scored},
         {"cell_size_m", world.cell_size_m},
         {"robots", world.robots},
         {"images", world.images},
         {"purity", toJson(over(world, [](const auto& r) { return r.purity; }))},
         {"rows", rows},
         {"bytes_per_robot",
          {{"topics", std::llround(first.topics_bytes)}, {"map", std::llround(first.map_bytes)}}},
         {"merged_bytes_per_robot",
          {{"sent", std::llround(first.merged_sent)}, {"received", std::llround(first.merged_received)}}},
         {"seconds", rounded(world.seconds, 1e6)}});
  }
  return json;
}

std::string tableOf(const Reproduction& all) {
  std::string text;
  for (const WorldResult& world : all.worlds) {
    text += fmt::format("{:<30} {:>7} {:>7} {:>8} {:>7} {:>15}\n", world.world, "AMI", "sd", "95 %", "labels",
                        "paper (sd)");
    for (const Row& r : rowsOf(all, world)) {
      text += fmt::format("{:<30} {:>7.3f} {:>7.3f} {:>8} {:>7.1f} {:>15}\n", r.name, r.newest.mean,
                          r.newest.deviation, fmt::format("+-{:.3f}", r.newest.margin), r.labels.mean,
                          published(world.world, r.name));
    }
    text += "\n";
  }
  return text + "report: " + all.options.out + "/report.html\n";
}

void writeReport(const Reproduction& all) {
  const auto write = [&](const std::string& name, const std::string& content) {
    mapping::writeFileAtomically(all.options.out + "/" + name, content);
  };
  write("table.csv", tableCsv(all));
  write("by_robots.csv", curvesCsv(all, "robots", byRobots));
  write("by_images.csv", curvesCsv(all, "images", byImages));
  write("by_shares.csv", curvesCsv(all, "shares", byShares));
  write("summary.json", summaryOf(all).dump(2) + "\n");
  write("report.html", html(all));
}

}  // namespace shoal::console
