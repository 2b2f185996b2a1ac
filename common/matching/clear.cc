// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/clear.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "shoal/matching/assignment.h"
#include "shoal/matching/clear_embedding.h"
#include "shoal/matching/constrained_clear.h"
#include "shoal/matching/spectrum.h"

namespace shoal::matching {
namespace {

// One robot's topics to distinct centres, best total score. Columns in which all its scores are 0 are all
// alike: the lowest ones will do.
std::vector<int> assignDistinct(const Place* topics, int num_topics, int num_columns) {
  const auto count = static_cast<size_t>(num_topics);
  std::vector<int> favourite(count);
  std::set<int> wanted;
  bool all_positive = true;
  for (size_t t = 0; t < count; ++t) {
    const size_t k = topics[t].best();
    favourite[t] = topics[t].column(k);
    all_positive = all_positive && topics[t].score(k) > 0.0;
    wanted.insert(favourite[t]);
  }
  if (all_positive && wanted.size() == count) return favourite;  // nobody stands in another's way

  std::set<int> used;
  for (size_t t = 0; t < count; ++t) {
    for (size_t k = 0; k < topics[t].numScores(); ++k) {
      if (topics[t].score(k) != 0.0) used.insert(topics[t].column(k));
    }
  }
  const size_t num_scored = used.size();
  for (int column = 0; column < num_columns && used.size() < num_scored + count; ++column)
    used.insert(column);

  const std::vector<int> columns(used.begin(), used.end());
  Eigen::MatrixXd cost =
      Eigen::MatrixXd::Constant(num_topics, static_cast<Eigen::Index>(columns.size()), 1e9);
  for (size_t t = 0; t < count; ++t) {
    for (size_t k = 0; k < topics[t].numScores(); ++k) {
      const auto at = std::lower_bound(columns.begin(), columns.end(), topics[t].column(k));
      if (at == columns.end() || *at != topics[t].column(k)) continue;
      cost(static_cast<Eigen::Index>(t), at - columns.begin()) -= topics[t].score(k);
    }
  }
  std::vector<int> chosen = assign(cost);
  for (int& column : chosen) column = columns[static_cast<size_t>(column)];
  return chosen;
}

// Brings the entries of each column into ascending order of their rows.
void sortColumns(Eigen::SparseMatrix<double>& matrix) {
  std::vector<std::pair<int, double>> column;
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    const int first = matrix.outerIndexPtr()[j];
    const int last = matrix.outerIndexPtr()[j + 1];
    int* const row = matrix.innerIndexPtr();
    double* const value = matrix.valuePtr();
    if (std::is_sorted(row + first, row + last)) continue;
    column.clear();
    for (int k = first; k < last; ++k) column.emplace_back(row[k], value[k]);
    std::sort(column.begin(), column.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (int k = first; k < last; ++k) {
      std::tie(row[k], value[k]) = column[static_cast<size_t>(k - first)];
    }
  }
}

void checkOptions(const ClearOptions& options) {
  if (!(options.eigenvalue_threshold > 0.0 && options.eigenvalue_threshold < 1.0)) {
    throw std::invalid_argument("eigenvalue_threshold must lie in (0, 1), got " +
                                std::to_string(options.eigenvalue_threshold));
  }
  if (!(options.eigenvalue_tolerance >= 0.0 && options.eigenvalue_tolerance < options.eigenvalue_threshold)) {
    throw std::invalid_argument("eigenvalue_tolerance must lie in [0, eigenvalue_threshold), got " +
                                std::to_string(options.eigenvalue_tolerance));
  }
}

}  // namespace

Eigen::SparseMatrix<double> normalizedLaplacian(const AssociationGraph& graph, bool distinct) {
  check(graph);
  const std::vector<int> owner = owners(graph);
  const auto n = static_cast<Eigen::Index>(owner.size());

  const auto counts = [&](const Edge& e) {
    return e.weight != 0.0 &&
           !(distinct && owner[static_cast<size_t>(e.i)] == owner[static_cast<size_t>(e.j)]);
  };
  Eigen::VectorXi entries = Eigen::VectorXi::Ones(n);  // per column; the diagonal is one
  for (const Edge& e : graph.edges) {
    if (!counts(e)) continue;
    ++entries[e.i];
    ++entries[e.j];
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.resizeNonZeros(entries.sum());
  std::partial_sum(entries.begin(), entries.end(), matrix.outerIndexPtr() + 1);
  std::vector<int> next(matrix.outerIndexPtr(), matrix.outerIndexPtr() + n);
  const auto put = [&](int row, int column, double value) {
    const int at = next[static_cast<size_t>(column)]++;
    matrix.innerIndexPtr()[at] = row;
    matrix.valuePtr()[at] = value;
  };
  // In this order columns ascend when the edges do.
  for (const Edge& e : graph.edges) {
    if (counts(e)) put(e.i, e.j, e.weight);
  }
  for (int v = 0; v < n; ++v) put(v, v, 0.0);
  for (const Edge& e : graph.edges) {
    if (counts(e)) put(e.j, e.i, e.weight);
  }
  sortColumns(matrix);

  // Summed along the sorted columns: the order of the edges changes no bit.
  const Eigen::VectorXd degree = matrix * Eigen::VectorXd::Ones(n);
  const Eigen::VectorXd root = (degree.array() + 1.0).sqrt();
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!std::isfinite(degree[j])) {
      throw std::invalid_argument("the weights at vertex " + std::to_string(j) + " have no finite sum");
    }
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, j); it; ++it) {
      it.valueRef() =
          it.row() == j ? degree[j] / (degree[j] + 1.0) : -it.value() / (root[it.row()] * root[j]);
    }
  }
  return matrix;
}

Clustering rectify(const AssociationGraph& graph, const ClearOptions& options,
                   const PairConstraints& constraints, SpectrumMemory* memory) {
  checkOptions(options);
  if (!constraints.empty()) return rectifyConstrained(graph, options, constraints, memory);
  const Eigen::SparseMatrix<double> laplacian = normalizedLaplacian(graph, options.distinct);
  const int n = graph.numVertices();
  if (n == 0) return {};

  // Universe: the eigenvalues below the threshold, and room for the largest robot.
  const int largest = *std::max_element(graph.num_topics.begin(), graph.num_topics.end());
  const SmallEnd end = smallEnd(laplacian, options.eigenvalue_threshold - options.eigenvalue_tolerance,
                                options.distinct ? largest : 0, memory);

  const std::vector<Embedding> embeddings = embed(end);

  // Alignment, robot by robot.
  const std::vector<Place> place = places(embeddings, n);
  std::vector<int> label;
  for (const int num_topics : graph.num_topics) {
    const Place* topics = place.data() + label.size();
    if (options.distinct) {
      const std::vector<int> columns = assignDistinct(topics, num_topics, end.num_kept);
      label.insert(label.end(), columns.begin(), columns.end());
    } else {
      for (int t = 0; t < num_topics; ++t) label.push_back(topics[t].column(topics[t].best()));
    }
  }
  return numberByFirstAppearance(label, end.num_kept);
}

}  // namespace shoal::matching
