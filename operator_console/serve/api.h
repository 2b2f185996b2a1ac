// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "operator_console/mission_sources.h"
#include "operator_console/serve/gate.h"
#include "operator_console/serve/held_maps.h"
#include "operator_console/serve/http_server.h"
#include "operator_console/serve/mission_feed.h"
#include "operator_console/serve/truth_layer.h"

namespace shoal::console {

/// What the page asks for, as docs/openapi.json describes it. Questions of mapping/questions.h are put to the
/// mission as the console's commands put them, so that terminal and page get the same answers.
class Api {
 public:
  /// `feed` and `truth` outlive it. @param life  changes with every start of the server: sequences of another
  /// are void.
  Api(Where where, MissionFeed& feed, TruthLayer& truth, Gate gate, uint64_t life);

  /// Answers anything. Thread-safe.
  HttpResponse answer(const HttpRequest& request);

  /// What a stream is told: {"life", "phase", "sequence", ...}.
  std::string news() const;

 private:
  HttpResponse get(const HttpRequest& request);
  HttpResponse map(const HttpRequest& request) const;
  HttpResponse pictures(const HttpRequest& request) const;
  HttpResponse picture(const HttpRequest& request) const;
  HttpResponse truth(const HttpRequest& request) const;
  std::shared_ptr<const Moment> momentFor(const HttpRequest& request) const;
  HttpResponse exportedMap(const HttpRequest& request) const;
  HttpResponse asked(const nlohmann::ordered_json& question) const;
  HttpResponse area(const HttpRequest& request) const;
  HttpResponse diff(const HttpRequest& request) const;
  HttpResponse holding(const HttpRequest& request) const;
  HttpResponse price(const HttpRequest& request) const;
  HttpResponse sharper(const nlohmann::ordered_json& question) const;
  HttpResponse order(const HttpRequest& request);

  Where where_;
  MissionFeed& feed_;
  TruthLayer& truth_;
  mutable HeldMaps held_;  // locks itself
  Gate gate_;
  uint64_t life_;
};

}  // namespace shoal::console
