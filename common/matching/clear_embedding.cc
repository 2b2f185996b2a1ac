// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/clear_embedding.h"

#include <cmath>
#include <set>
#include <tuple>

namespace shoal::matching {
namespace {

// Sums and scores are compared in whole units of 1e-9, so that round-off decides nothing.
double rounded(double x) { return std::nearbyint(x * 1e9); }

std::vector<Embedding> lift(const SmallEnd& end) {
  std::vector<Embedding> embeddings;
  for (const ComponentSpectrum& c : end.components) {
    Embedding& e = embeddings.emplace_back();
    e.vertices = c.vertices;
    // No row is zero: the eigenvector of eigenvalue 0 is positive on all of its component.
    e.rows = c.eigenvectors.rowwise().normalized();
    e.likeness = Eigen::VectorXd::Zero(e.rows.rows());
    e.is_pivot.assign(c.vertices.size(), false);
  }
  return embeddings;
}

// The topic of a component that would be its next centre: (likeness, vertex, component, row).
using Candidate = std::tuple<double, int, size_t, int>;

void addBestCandidate(const Embedding& e, size_t component, std::set<Candidate>& candidates) {
  int best = -1;
  for (int i = 0; i < e.rows.rows(); ++i) {
    if (e.is_pivot[static_cast<size_t>(i)]) continue;
    if (best < 0 || rounded(e.likeness[i]) < rounded(e.likeness[best])) best = i;
  }
  if (best < 0) return;
  candidates.emplace(rounded(e.likeness[best]), e.vertices[static_cast<size_t>(best)], component, best);
}

// Greedy choice of `count` centres: vertex 0, then always the topic least like those chosen, ties to the
// lower vertex. Topics of different components are not alike at all, so each choice touches one component.
void choosePivots(std::vector<Embedding>& embeddings, int count) {
  std::set<Candidate> candidates;
  for (size_t c = 0; c < embeddings.size(); ++c) addBestCandidate(embeddings[c], c, candidates);
  for (int column = 0; column < count; ++column) {
    const auto [likeness, vertex, component, row] = *candidates.begin();
    candidates.erase(candidates.begin());
    Embedding& e = embeddings[component];
    e.pivots.push_back(row);
    e.columns.push_back(column);
    e.is_pivot[static_cast<size_t>(row)] = true;
    e.likeness += (e.rows * e.rows.row(row).transpose()).cwiseAbs();
    addBestCandidate(e, component, candidates);
  }
  for (Embedding& e : embeddings) {
    e.scores = (e.rows * e.rows(e.pivots, Eigen::all).transpose()).unaryExpr(&rounded);
  }
}

}  // namespace

size_t Place::best() const {
  Eigen::Index k = 0;
  embedding->scores.row(row).maxCoeff(&k);
  return static_cast<size_t>(k);
}

std::vector<Embedding> embed(const SmallEnd& end) {
  std::vector<Embedding> embeddings = lift(end);
  choosePivots(embeddings, end.num_kept);
  return embeddings;
}

std::vector<Place> places(const std::vector<Embedding>& embeddings, int num_vertices) {
  std::vector<Place> place(static_cast<size_t>(num_vertices));
  for (const Embedding& e : embeddings) {
    for (size_t i = 0; i < e.vertices.size(); ++i) {
      place[static_cast<size_t>(e.vertices[i])] = {&e, static_cast<int>(i)};
    }
  }
  return place;
}

}  // namespace shoal::matching
