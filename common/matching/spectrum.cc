// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/spectrum.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shoal/demand.h"
#include "shoal/matching/eigenpairs.h"

namespace shoal::matching {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kEqual = 1e-9;  // eigenvalues closer than this are one eigenvalue

// I - L on one component: what is small in L is great in it.
Sparse complement(const Sparse& laplacian, const std::vector<int>& vertices, std::vector<int>& position) {
  const int size = static_cast<int>(vertices.size());
  for (int k = 0; k < size; ++k) position[static_cast<size_t>(vertices[static_cast<size_t>(k)])] = k;
  Eigen::Index count = 0;
  for (const int v : vertices) count += laplacian.col(v).nonZeros();
  Sparse block(size, size);
  block.reserve(count);
  for (int k = 0; k < size; ++k) {
    block.startVec(k);
    for (Sparse::InnerIterator it(laplacian, vertices[static_cast<size_t>(k)]); it; ++it) {
      const int row = position[static_cast<size_t>(it.row())];  // positions ascend as vertices do
      block.insertBack(row, k) = (row == k ? 1.0 : 0.0) - it.value();
    }
  }
  block.finalize();
  return block;
}

// A clique of s unit weights has I - L = 11'/s.
bool isClique(const Sparse& block) {
  if (block.nonZeros() != block.rows() * block.rows()) return false;
  const double expected = 1.0 / static_cast<double>(block.rows());
  return ((block.coeffs() - expected).abs() <= 1e-14).all();
}

// All eigenpairs of L on one component with eigenvalue below `bound`, and the one at 0.
ComponentSpectrum componentSpectrum(const std::vector<int>& vertices, const Sparse& block, double bound,
                                    SpectrumMemory* memory) {
  const auto size = static_cast<Eigen::Index>(vertices.size());
  if (size == 1 || (bound < 1.0 && isClique(block))) {
    return {vertices, Eigen::VectorXd::Zero(1),
            Eigen::MatrixXd::Constant(size, 1, 1.0 / std::sqrt(static_cast<double>(size)))};
  }
  // Not closer to 0 than round-off, so that the eigenvalue 0 is always among them.
  const double above = 1.0 - std::max(bound, 1e-9);
  Eigenpairs pairs = memory == nullptr
                         ? eigenpairsAbove(block, above)
                         : memory->remember(block, above, [&] { return eigenpairsAbove(block, above); });
  SHOAL_DEMAND(pairs.values.size() > 0);
  Eigen::VectorXd eigenvalues = (1.0 - pairs.values.array()).max(0.0);
  eigenvalues[0] = 0.0;
  return {vertices, std::move(eigenvalues), std::move(pairs.vectors)};
}

int numKept(const std::vector<ComponentSpectrum>& components) {
  Eigen::Index sum = 0;
  for (const ComponentSpectrum& c : components) sum += c.eigenvalues.size();
  return static_cast<int>(sum);
}

// The first `count` of a basis of the span of `basis` (s×g, orthonormal) that depends on the span alone.
Eigen::MatrixXd canonicalBasis(const Eigen::MatrixXd& basis, Eigen::Index count) {
  Eigen::MatrixXd turn(basis.cols(), count);  // the new basis in terms of the old, orthonormal columns
  Eigen::Index done = 0;
  for (Eigen::Index v = 0; v < basis.rows() && done < count; ++v) {
    Eigen::VectorXd projection = basis.row(v).transpose();  // of vertex v onto the span
    for (int twice = 0; twice < 2; ++twice) {
      projection -= turn.leftCols(done) * (turn.leftCols(done).transpose() * projection);
    }
    const double length = projection.norm();
    if (length > 1e-5) turn.col(done++) = projection / length;
  }
  SHOAL_DEMAND(done == count);
  return basis * turn;
}

// Keeps the `count` smallest eigenpairs of all.
void cut(std::vector<ComponentSpectrum>& components, int count) {
  std::vector<double> all;
  for (const ComponentSpectrum& c : components) {
    all.insert(all.end(), c.eigenvalues.begin(), c.eigenvalues.end());
  }
  std::nth_element(all.begin(), all.begin() + (count - 1), all.end());
  const double last = all[static_cast<size_t>(count - 1)];
  Eigen::Index open = count;
  for (const ComponentSpectrum& c : components) open -= (c.eigenvalues.array() < last - kEqual).count();
  for (ComponentSpectrum& c : components) {
    const Eigen::Index below = (c.eigenvalues.array() < last - kEqual).count();
    const Eigen::Index equal = (c.eigenvalues.array() <= last + kEqual).count() - below;
    const Eigen::Index take = std::min(equal, open);
    open -= take;
    if (take > 0 && take < equal) {
      const Eigen::MatrixXd basis = canonicalBasis(c.eigenvectors.middleCols(below, equal), take);
      c.eigenvectors.middleCols(below, take) = basis;
    }
    c.eigenvalues.conservativeResize(below + take);
    c.eigenvectors.conservativeResize(Eigen::NoChange, below + take);
  }
}

}  // namespace

std::vector<std::vector<int>> connectedComponents(const Sparse& matrix) {
  std::vector<std::vector<int>> components;
  std::vector<bool> seen(static_cast<size_t>(matrix.cols()), false);
  for (int start = 0; start < matrix.cols(); ++start) {
    if (seen[static_cast<size_t>(start)]) continue;
    std::vector<int>& component = components.emplace_back(1, start);
    seen[static_cast<size_t>(start)] = true;
    for (size_t next = 0; next < component.size(); ++next) {
      for (Sparse::InnerIterator it(matrix, component[next]); it; ++it) {
        const auto v = static_cast<size_t>(it.row());
        if (seen[v]) continue;
        seen[v] = true;
        component.push_back(static_cast<int>(v));
      }
    }
    std::sort(component.begin(), component.end());
  }
  return components;
}

SmallEnd smallEnd(const Sparse& laplacian, double bound, int at_least, SpectrumMemory* memory) {
  SHOAL_DEMAND(at_least <= laplacian.rows());
  SmallEnd end;
  std::vector<int> position(static_cast<size_t>(laplacian.rows()));
  std::vector<Sparse> blocks;
  for (const std::vector<int>& vertices : connectedComponents(laplacian)) {
    blocks.push_back(complement(laplacian, vertices, position));
    end.components.push_back(componentSpectrum(vertices, blocks.back(), bound, memory));
  }
  end.num_below = end.num_kept = numKept(end.components);
  if (end.num_below >= at_least) return end;

  // Too few: raise the bound until there are enough, and the eigenspace at the cut is complete.
  for (double higher = bound + 0.05; end.num_kept < at_least; higher += 0.05) {
    for (size_t c = 0; c < blocks.size(); ++c) {
      end.components[c] = componentSpectrum(end.components[c].vertices, blocks[c], higher, memory);
    }
    end.num_kept = numKept(end.components);
  }
  cut(end.components, at_least);
  end.num_kept = at_least;
  return end;
}

}  // namespace shoal::matching
