#include "scenarios/error_distribution.h"

#include <algorithm>
#include <cmath>

namespace sf::scenarios {

namespace {

constexpr std::size_t kMostKept = 4'000'000;

double error_between(double ours, double theirs) {
  if ((std::isnan(ours) && std::isnan(theirs)) || ours == theirs) return 0.0;
  const double error = std::abs(ours - theirs);
  return std::isnan(error) ? HUGE_VAL : error;
}

}  // namespace

double covering_bound(const base::ReadingBlock& reading, std::size_t element, double value) {
  const bool flagged = !reading.quality.empty() && reading.quality[element] != base::QualityFlag::none;
  return flagged || std::isnan(value) ? HUGE_VAL : reading.bound;
}

void ErrorDistribution::add(double ours, double theirs, double bound) {
  const double error = error_between(ours, theirs);
  if (count_++ % stride_ == 0) kept_.push_back(error);
  if (kept_.size() > kMostKept) {
    for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = kept_[2 * i];
    kept_.resize((kept_.size() + 1) / 2);
    stride_ *= 2;
  }
  zero_ += error == 0.0 ? 1 : 0;
  max_ = std::max(max_, error);
  if (std::isinf(bound)) return;
  ++covered_;
  covered_max_ = std::max(covered_max_, error);
  bound_ = std::max(bound_, bound);
}

double ErrorDistribution::quantile(double part) const {
  if (kept_.empty()) return 0.0;
  std::vector<double> errors = kept_;
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(errors.size() - 1));
  std::nth_element(errors.begin(), at, errors.end());
  return *at;
}

}  // namespace sf::scenarios
