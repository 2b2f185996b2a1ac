// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/bayesian_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "shoal/random.h"

namespace shoal::eval {
namespace {

constexpr int kCandidates = 1000;
constexpr double kKappa = 2.0;
constexpr uint64_t kStream = 0x74756e65;  // "tune"

using CubePoint = Eigen::VectorXd;  // in the unit cube

CubePoint toCube(const std::vector<Knob>& knobs, const std::vector<double>& values) {
  if (values.size() != knobs.size()) throw std::invalid_argument("a setting needs one value for each knob");
  CubePoint p(static_cast<Eigen::Index>(knobs.size()));
  for (size_t i = 0; i < knobs.size(); ++i) {
    p[static_cast<Eigen::Index>(i)] =
        std::log(values[i] / knobs[i].low) / std::log(knobs[i].high / knobs[i].low);
  }
  return p;
}

std::vector<double> fromCube(const std::vector<Knob>& knobs, const CubePoint& p) {
  std::vector<double> values;
  for (size_t i = 0; i < knobs.size(); ++i) {
    const double value =
        knobs[i].low * std::pow(knobs[i].high / knobs[i].low, p[static_cast<Eigen::Index>(i)]);
    // Three digits: what is tried is what is printed.
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2);
    values.push_back(std::clamp(std::round(value / unit) * unit, knobs[i].low, knobs[i].high));
  }
  return values;
}

void check(const std::vector<Knob>& knobs) {
  if (knobs.empty()) throw std::invalid_argument("there is no knob to tune");
  for (const Knob& k : knobs) {
    if (!(k.low > 0 && k.high > k.low && std::isfinite(k.high))) {
      throw std::invalid_argument("knob " + k.name + " needs a range 0 < low < high");
    }
  }
}

// A Gaussian process over the unit cube, scores taken to mean 0 and deviation 1.
class Process {
 public:
  Process(const std::vector<CubePoint>& points, const Eigen::VectorXd& scores) : points_(points) {
    mean_ = scores.mean();
    scale_ = std::sqrt((scores.array() - mean_).square().mean());
    if (!(scale_ > 0)) scale_ = 1;
    const Eigen::VectorXd y = (scores.array() - mean_) / scale_;
    double most = -INFINITY;
    for (const double width : {.1, .2, .4, .8, 1.6}) {
      for (const double noise : {.01, .1, .3, 1.0}) {
        const double likelihood = fit(y, width, noise);
        if (likelihood <= most) continue;
        most = likelihood;
        width_ = width;
        noise_ = noise;
      }
    }
    fit(y, width_, noise_);
  }

  struct Guess {
    double mean, deviation;
  };
  Guess at(const CubePoint& p) const {
    Eigen::VectorXd k(std::ssize(points_));
    for (Eigen::Index i = 0; i < k.size(); ++i) k[i] = kernel(p, points_[static_cast<size_t>(i)], width_);
    const double variance = 1.0 - k.dot(cholesky_.solve(k));
    return {mean_ + scale_ * k.dot(weights_), scale_ * std::sqrt(std::max(variance, 0.0))};
  }

 private:
  static double kernel(const CubePoint& a, const CubePoint& b, double width) {  // Matérn 5/2
    const double r = std::sqrt(5.0) * (a - b).norm() / width;
    return (1 + r + r * r / 3) * std::exp(-r);
  }

  // Returns the logarithm of the marginal likelihood, up to a constant.
  double fit(const Eigen::VectorXd& y, double width, double noise) {
    const Eigen::Index n = y.size();
    Eigen::MatrixXd k(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        k(i, j) = k(j, i) = kernel(points_[static_cast<size_t>(i)], points_[static_cast<size_t>(j)], width);
      }
      k(i, i) += noise;
    }
    cholesky_.compute(k);
    weights_ = cholesky_.solve(y);
    return -0.5 * y.dot(weights_) - cholesky_.matrixLLT().diagonal().array().log().sum();
  }

  const std::vector<CubePoint>& points_;
  double mean_ = 0, scale_ = 1, width_ = 0, noise_ = 0;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  Eigen::VectorXd weights_;
};

struct Data {
  std::vector<CubePoint> points;
  Eigen::VectorXd scores;
};

Data dataOf(const std::vector<Knob>& knobs, const std::vector<Tried>& tried) {
  Data data{{}, Eigen::VectorXd(std::ssize(tried))};
  for (size_t i = 0; i < tried.size(); ++i) {
    data.points.push_back(toCube(knobs, tried[i].values));
    data.scores[static_cast<Eigen::Index>(i)] = tried[i].score;
  }
  return data;
}

}  // namespace

std::vector<double> nextSetting(const std::vector<Knob>& knobs, const std::vector<Tried>& tried, int random,
                                uint64_t seed) {
  check(knobs);
  const auto dimensions = static_cast<Eigen::Index>(knobs.size());
  Random draw(seed, kStream, tried.size());
  if (std::ssize(tried) < std::max(random, 2)) {
    // Roberts' additive lattice: powers of the inverse of the root of x^(d + 1) = x + 1, shifted by the seed.
    double root = 2;
    for (int i = 0; i < 64; ++i) root = std::pow(1 + root, 1.0 / static_cast<double>(dimensions + 1));
    Random shift(seed, kStream);
    CubePoint p(dimensions);
    for (Eigen::Index d = 0; d < dimensions; ++d) {
      const double x = shift.uniform() +
                       static_cast<double>(tried.size() + 1) / std::pow(root, static_cast<double>(d + 1));
      p[d] = x - std::floor(x);
    }
    return fromCube(knobs, p);
  }
  const Data data = dataOf(knobs, tried);
  const Process process(data.points, data.scores);
  std::optional<double> most;
  CubePoint best;
  for (int i = 0; i < kCandidates; ++i) {
    CubePoint p(dimensions);
    for (Eigen::Index d = 0; d < dimensions; ++d) p[d] = draw.uniform();
    const Process::Guess guess = process.at(p);
    const double bound = guess.mean + kKappa * guess.deviation;
    if (most && bound <= *most) continue;
    most = bound;
    best = p;
  }
  return fromCube(knobs, best);
}

size_t bestSetting(const std::vector<Knob>& knobs, const std::vector<Tried>& tried) {
  check(knobs);
  if (tried.empty()) throw std::invalid_argument("nothing was tried");
  const Data data = dataOf(knobs, tried);
  const Process process(data.points, data.scores);
  size_t best = 0;
  for (size_t i = 1; i < tried.size(); ++i) {
    if (process.at(data.points[i]).mean > process.at(data.points[best]).mean) best = i;
  }
  return best;
}

}  // namespace shoal::eval
