// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/api.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/picture_files.h"
#include "operator_console/asking.h"
#include "operator_console/exports.h"
#include "operator_console/label_pictures.h"
#include "operator_console/recorded_mission.h"
#include "operator_console/render.h"
#include "operator_console/serve/page_files.h"
#include "shoal/mapping/area_answer.h"
#include "shoal/mapping/diff_answer.h"
#include "shoal/version.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

HttpResponse json(const Json& value, int status = 200) {
  return {.status = status, .body = value.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

HttpResponse error(int status, const std::string& text) { return json({{"error", text}}, status); }

const std::string* find(const HttpRequest& request, const char* key) {
  const auto at = request.query.find(key);
  return at == request.query.end() || at->second.empty() ? nullptr : &at->second;
}

std::string text(const HttpRequest& request, const char* key) {
  const std::string* value = find(request, key);
  if (value == nullptr) throw std::invalid_argument(std::string("the parameter \"") + key + "\" is missing");
  return *value;
}

double number(const std::string& value, const char* key) {
  double result = 0;
  const auto [end, problem] = std::from_chars(value.data(), value.data() + value.size(), result);
  if (problem != std::errc{} || end != value.data() + value.size() || !std::isfinite(result)) {
    throw std::invalid_argument(std::string("\"") + key + "\" is a number; got \"" + value + "\"");
  }
  return result;
}

double number(const HttpRequest& request, const char* key) { return number(text(request, key), key); }

int64_t wholeNumber(const HttpRequest& request, const char* key) {
  const double value = number(request, key);
  if (value != std::floor(value) || !(std::abs(value) < 1e9)) {
    throw std::invalid_argument(std::string("\"") + key + "\" is a whole number");
  }
  return static_cast<int64_t>(value);
}

}  // namespace

Api::Api(Where where, MissionFeed& feed, TruthLayer& truth, Gate gate, uint64_t life)
    : where_(std::move(where)),
      feed_(feed),
      truth_(truth),
      held_(where_, feed),
      gate_(std::move(gate)),
      life_(life) {}

// Of the mission time "at", or the newest; as "node" held it, when one is named; nullptr before the first.
std::shared_ptr<const Moment> Api::momentFor(const HttpRequest& request) const {
  const std::string* time = find(request, "at");
  if (const std::string* node = find(request, "node"); node != nullptr) {
    return held_.of(*node, time == nullptr ? std::nullopt : std::optional(number(*time, "at"))).moment;
  }
  return time == nullptr ? feed_.now() : feed_.at(number(*time, "at"));
}

std::string Api::news() const {
  Json news = feed_.report();
  news.erase("times_s");
  news["life"] = std::to_string(life_);
  return news.dump();
}

HttpResponse Api::answer(const HttpRequest& request) {
  if (const std::string refusal = gate_.refusal(request); !refusal.empty()) return error(403, refusal);
  try {
    if (request.method == "GET" || request.method == "HEAD") return get(request);
    if (request.method == "POST" && (request.path == "/api/edit" || request.path == "/api/ask"))
      return order(request);
    return error(405, "GET everything, POST /api/edit and /api/ask");
  } catch (const std::invalid_argument& problem) {
    return error(400, problem.what());
  } catch (const std::runtime_error& problem) {
    return error(404, problem.what());
  }
}

HttpResponse Api::get(const HttpRequest& request) {
  const std::string& path = request.path;
  if (const PageFile* file = pageFile(path)) return {.type = file->type, .body = std::string(file->content)};
  if (path == "/api/map") return map(request);
  if (path == "/api/stream") {
    return {.type = "text/event-stream", .body = "retry: 1000\ndata: " + news() + "\n\n", .is_stream = true};
  }
  if (path == "/api/mission") {
    Json mission = feed_.report();
    mission["life"] = std::to_string(life_);
    mission["version"] = std::string(version()) + " (" + commit() + ")";
    mission["source"] = !where_.node.empty() ? "node" : !where_.run.empty() ? "run" : "log";
    mission["place"] = where_.node + where_.run + where_.log;
    mission["read_only"] = gate_.token.empty();
    mission["truth"] = truth_.isNamed();
    mission["formats"] = Json::array();
    mission["exports"] = Json::array();
    for (const ExportFormat& f : exportFormats()) {
      mission["formats"].push_back(f.name);
      mission["exports"].push_back({{"format", f.name},
                                    {"file", f.file},
                                    {"beside", f.beside},
                                    {"what", f.what},
                                    {"origin", f.origin == ExportFormat::Origin::kNone    ? "no"
                                               : f.origin == ExportFormat::Origin::kTaken ? "may"
                                                                                          : "must"}});
    }
    return json(mission);
  }
  if (path == "/api/status" || path == "/api/labels") {
    const std::string* time = find(request, "at");
    const auto moment = momentFor(request);
    if (!moment) return error(503, "nothing is known of the mission yet");
    if (path == "/api/status") return json(moment->status);
    Json labels = moment->labels;
    if (time == nullptr && find(request, "node") == nullptr && where_.node.empty())
      addPictures(where_, labels.at("labels"));
    return json(labels);
  }
  if (path == "/api/tracks" || path == "/api/traffic" || path == "/api/events") {
    return json(feed_.chronicle(path.substr(5)));
  }
  if (path == "/api/at") {
    return asked({{"query", "at"}, {"x", number(request, "x")}, {"y", number(request, "y")}});
  }
  if (path == "/api/area") return area(request);
  if (path == "/api/why") return asked({{"query", "why"}, {"label", text(request, "label")}});
  if (path == "/api/ask") return price(request);
  if (path == "/api/holding") return holding(request);
  if (path == "/api/node") return asked({{"query", "node"}, {"node", text(request, "node")}});
  if (path == "/api/surprises") {
    Json question{{"query", "surprises"}};
    if (find(request, "least") != nullptr) question["least"] = number(request, "least");
    return asked(question);
  }
  if (path == "/api/edits") return asked({{"query", "edits"}});
  if (path == "/api/diff") return diff(request);
  if (path == "/api/pictures") return pictures(request);
  if (path == "/api/picture") return picture(request);
  if (path == "/api/classes" || path == "/api/truth") return truth(request);
  if (path == "/api/export") return exportedMap(request);
  return error(404, "there is nothing of that name; /openapi.json says what there is");
}

// Which pictures there are of each label's topics; picture() has one of them.
HttpResponse Api::pictures(const HttpRequest& request) const {
  const auto moment = momentFor(request);
  if (!moment) return error(503, "nothing is known of the mission yet");
  Json labels = Json::array();
  for (const auto& [label, held] : *moment->pictures) {
    Json row{{"label", world::number(label)}, {"pictures", Json::array()}};
    for (const mapping::HeldPicture& p : held) {
      row["pictures"].push_back({{"robot", world::name(p.robot)},
                                 {"topic", world::number(p.topic)},
                                 {"example", p.number},
                                 {"seen_s", p.seen.seconds()},
                                 {"layers", p.layers.size()},
                                 {"num_layers", p.num_layers}});
    }
    labels.push_back(std::move(row));
  }
  return json({{"labels", std::move(labels)}});
}

HttpResponse Api::picture(const HttpRequest& request) const {
  const auto moment = momentFor(request);
  if (!moment) return error(503, "nothing is known of the mission yet");
  const std::string robot = text(request, "robot");
  const double topic = number(request, "topic"), example = number(request, "example");
  for (const auto& [label, held] : *moment->pictures) {
    for (const mapping::HeldPicture& p : held) {
      if (world::name(p.robot) != robot || world::number(p.topic) != topic || p.number != example) continue;
      return {.type = "image/png", .body = encodePng(fusion_node::pixelsOf(p))};
    }
  }
  return error(404, "nobody has told of such a picture; /api/pictures lists those that there are");
}

HttpResponse Api::truth(const HttpRequest& request) const {
  const auto moment = momentFor(request);
  if (!moment) return error(503, "nothing is known of the mission yet");
  if (request.path == "/api/classes") {
    const Json classes = truth_.classes();
    return classes.is_null() ? error(503, "the truth is being found out") : json(classes);
  }
  const auto tiles = truth_.tiles(*moment);
  if (!tiles) return error(503, "the truth is being found out");
  return {
      .type = "application/octet-stream",
      .body = encodeTiles(*tiles, 0, {moment->cell_size_m, moment->base_s, moment->sequence, life_}, false)};
}

HttpResponse Api::exportedMap(const HttpRequest& request) const {
  const ExportFormat& format = exportFormat(text(request, "format"));
  std::optional<GeoOrigin> origin;
  if (find(request, "latitude") != nullptr || find(request, "longitude") != nullptr) {
    origin = GeoOrigin{number(request, "latitude"), number(request, "longitude"), 0};
    if (find(request, "heading") != nullptr) origin->heading_deg = number(request, "heading");
  } else if (find(request, "heading") != nullptr) {
    throw std::invalid_argument("\"heading\" goes with \"latitude\" and \"longitude\"");
  }
  const std::string* packed = find(request, "packed");
  if (packed != nullptr && *packed != "zip") throw std::invalid_argument("\"packed\" is zip, or not there");
  const std::vector<ExportedFile> files = exported(where_, format.name, format.file, origin).files;
  HttpResponse file{.type = "application/octet-stream", .body = {}};
  file.file_name = format.file;
  if (packed == nullptr) {
    file.body = files.front().content;
  } else {
    file.body = zipOf(files);
    file.file_name += ".zip";
  }
  return file;
}

HttpResponse Api::map(const HttpRequest& request) const {
  const std::string* time = find(request, "at");
  const auto moment = momentFor(request);
  if (!moment) return error(503, "nothing is known of the mission yet");
  uint64_t since = 0;
  const std::string* life = find(request, "life");
  if (time == nullptr && find(request, "node") == nullptr && life != nullptr &&
      *life == std::to_string(life_) && find(request, "since") != nullptr) {
    const double asked = number(request, "since");
    if (asked >= static_cast<double>(moment->chain) && asked <= static_cast<double>(moment->sequence))
      since = static_cast<uint64_t>(asked);
  }
  const std::string* cells = find(request, "cells");
  if (cells != nullptr && *cells != "all") throw std::invalid_argument("\"cells\" is all, or not there");
  return {
      .type = "application/octet-stream",
      .body = encodeTiles(moment->tiles, since,
                          {moment->cell_size_m, moment->base_s, moment->sequence, life_}, cells != nullptr)};
}

HttpResponse Api::asked(const Json& question) const {
  const Json answer = ask(where_, question);
  return json(answer, answer.contains("error") ? 400 : 200);
}

HttpResponse Api::area(const HttpRequest& request) const {
  Json question{{"query", "area"}, {"label", text(request, "label")}};
  for (const char* key : {"min_m2", "since_s", "certainty"})
    if (find(request, key) != nullptr) question[key] = number(request, key);
  const std::string* format = find(request, "format");
  if (format == nullptr || *format == "json") return asked(question);
  const Json answer = ask(where_, question);
  if (answer.contains("error")) return json(answer, 400);
  if (*format == "csv") return {.type = "text/csv", .body = mapping::areaCsv(answer)};
  if (*format == "geojson") return json(mapping::areasGeoJson(Json::array({answer})));
  throw std::invalid_argument("\"" + *format + "\" is no format of patches; json, csv and geojson are");
}

HttpResponse Api::diff(const HttpRequest& request) const {
  const double from_s = number(request, "from"), until_s = number(request, "until");
  if (!(0 <= from_s && from_s <= until_s && until_s <= 4e12)) {
    throw std::invalid_argument("diff goes from the earlier to the later mission time, seconds");
  }
  const auto viewAt = [&where = where_, log = recordingOf(where_),
                       matcher = matcherOf(where_)](double time_s) {
    const world::Timestamp until{std::llround(time_s * 1e6)};
    return readRecording(log, matcher, {}, until, where.key).state.view();
  };
  return json(mapping::diffAnswer(viewAt(from_s), from_s, viewAt(until_s), until_s));
}

// What a node held of the others, and until when.
HttpResponse Api::holding(const HttpRequest& request) const {
  const std::string* time = find(request, "at");
  return json(
      held_.of(text(request, "node"), time == nullptr ? std::nullopt : std::optional(number(*time, "at")))
          .says);
}

// What a sharper picture would cost.
HttpResponse Api::price(const HttpRequest& request) const {
  Json question{{"query", "ask"}, {"dry_run", true}};
  if (find(request, "label") != nullptr) {
    question["label"] = text(request, "label");
  } else {
    question["robot"] = text(request, "robot");
    question["topic"] = wholeNumber(request, "topic");
  }
  if (find(request, "example") != nullptr) question["example"] = wholeNumber(request, "example");
  return sharper(question);
}

// Only a running node can pass a question on to a robot.
HttpResponse Api::sharper(const Json& question) const {
  if (where_.node.empty()) return error(404, "the mission is over: there is nobody to ask");
  return asked(question);
}

// What only who has the token may do: decide, and spend bytes of the link.
HttpResponse Api::order(const HttpRequest& request) {
  if (gate_.token.empty()) return error(403, "this console is read-only");
  if (!gate_.mayWrite(request))
    return error(401, "show the token that serve printed: Authorization: Bearer TOKEN");
  Json question = Json::parse(request.body, nullptr, false);
  if (request.path == "/api/ask") {
    if (!question.is_object()) {
      throw std::invalid_argument(
          R"(what is asked for is a JSON object: {"robot": "R03", "topic": 7, "example": 0})");
    }
    question["query"] = "ask";
    question["dry_run"] = false;
    question.erase("edit");
    return sharper(question);
  }
  if (!question.is_object() || !question.contains("edit")) {
    throw std::invalid_argument(
        R"(an edit is a JSON object: {"edit": "name", "label": "10004", "text": "sand"})");
  }
  try {
    const HttpResponse answer = asked(question);
    if (answer.status == 200) feed_.lookAgain();
    return answer;
  } catch (const Json::exception& wrong) {
    throw std::invalid_argument(std::string("the edit lacks something: ") + wrong.what());
  }
}

}  // namespace shoal::console
