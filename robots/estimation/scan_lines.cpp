// Lines in a scan: split at corners, merged again where noise split them, and fitted.

#include <cmath>

#include "base/elementary.h"
#include "robots/estimation/scan_features.h"

namespace sf::estimation {

namespace {

constexpr double kSplitSigmas = 3.0;
constexpr double kJointSigmas = 6.0;  // length of a joint between two lines
constexpr double kMostMisfit = 3.0;   // weighted squared residual per echo of a line

}  // namespace

/// Splits at the echo that is farthest from the chord, until all are within the noise.
void ScanFeatures::split(std::size_t first, std::size_t last) {
  open_.assign(1, {first, last});
  while (!open_.empty()) {
    const auto [from, to] = open_.back();
    open_.pop_back();
    const glm::dvec2 chord = echoes_[to].p - echoes_[from].p;
    const double length = glm::length(chord);
    std::size_t farthest = from;
    double worst = 1.0;
    for (std::size_t i = from + 1; i < to && length > 0.0; ++i) {
      const Echo& echo = echoes_[i];
      const glm::dvec2 normal = left_of(chord / length);
      const double off = glm::dot(echo.p - echoes_[from].p, normal);
      const double toward = glm::dot(normal, echo.sight);
      const double variance = echo.along * toward * toward + echo.across * (1.0 - toward * toward);
      // The chord's ends have the same noise.
      const double share = std::abs(off) / (kSplitSigmas * std::sqrt(2.0 * variance));
      if (share > worst) worst = share, farthest = i;
    }
    if (farthest == from) {
      pieces_.push_back(fit(from, to));
      pieces_.back().is_line = straight(pieces_.back());
    } else {
      open_.push_back({farthest + 1, to});
      open_.push_back({from, farthest});
    }
  }
}

/// Joins neighbours that fit one line: the split echo may have been an outlier.
void ScanFeatures::merge() {
  for (std::size_t k = 0; k + 1 < pieces_.size();) {
    Line joined = fit(pieces_[k].first, pieces_[k + 1].last);
    joined.is_line = straight(joined);
    const bool longer = joined.last - joined.first + 1 > 2;
    if (joined.is_line && longer) {
      pieces_[k] = joined;
      pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(k) + 1);
      if (k > 0) --k;
    } else {
      ++k;
    }
  }
}

/// Leaves out the echoes near a joint, some of which may be those of the neighbour.
void ScanFeatures::trim(Line& line, bool at_first, bool at_last) const {
  const auto count = [&](std::size_t from, std::ptrdiff_t step) {
    std::size_t n = 0;
    const Echo& end = echoes_[from];
    const double joint = kJointSigmas * std::sqrt(end.along + end.across);
    while (n < line.last - line.first &&
           glm::length(echoes_[from + static_cast<std::size_t>(step * static_cast<std::ptrdiff_t>(n))].p - end.p) <
               joint)
      ++n;
    return n;
  };
  const std::size_t before = at_first ? count(line.first, 1) : 0, after = at_last ? count(line.last, -1) : 0;
  if (line.last - line.first + 1 < before + after + options_.least) return;
  Line inner = fit(line.first + before, line.last - after);
  inner.first = line.first, inner.last = line.last, inner.is_line = true;
  line = inner;
}

ScanFeatures::Line ScanFeatures::fit(std::size_t first, std::size_t last) const {
  Line line{.first = first, .last = last};
  const glm::dvec2 chord = echoes_[last].p - echoes_[first].p;
  const double length = glm::length(chord);
  line.along = length > 0.0 ? chord / length : left_of(echoes_[first].sight);
  // The weights depend on the direction: twice.
  for (int pass = 0; pass < 2; ++pass) {
    const glm::dvec2 normal = left_of(line.along), origin = echoes_[first].p;
    const auto weight_of = [&](const Echo& echo) {
      const double toward = glm::dot(normal, echo.sight);
      return 1.0 / (echo.along * toward * toward + echo.across * (1.0 - toward * toward));
    };
    double sum = 0.0;
    glm::dvec2 mean;
    for (std::size_t i = first; i <= last; ++i) {
      const double weight = weight_of(echoes_[i]);
      sum += weight, mean += weight * (echoes_[i].p - origin);
    }
    mean /= sum;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
      const glm::dvec2 d = echoes_[i].p - origin - mean;
      const double weight = weight_of(echoes_[i]);
      xx += weight * d.x * d.x, xy += weight * d.x * d.y, yy += weight * d.y * d.y;
    }
    const double angle = 0.5 * base::atan2(2.0 * xy, xx - yy);
    const glm::dvec2 axis = base::direction(angle);
    if (last > first) line.along = glm::dot(axis, chord) < 0.0 ? -axis : axis;
    const glm::dvec2 across = left_of(line.along);
    line.centre = origin + mean, line.weight = sum;
    line.spread =
        xx * line.along.x * line.along.x + 2.0 * xy * line.along.x * line.along.y + yy * line.along.y * line.along.y;
    line.misfit = xx * across.x * across.x + 2.0 * xy * across.x * across.y + yy * across.y * across.y;
  }
  line.from = glm::dot(echoes_[first].p - line.centre, line.along);
  line.to = glm::dot(echoes_[last].p - line.centre, line.along);
  return line;
}

bool ScanFeatures::straight(const Line& line) const {
  const auto count = static_cast<double>(line.last - line.first + 1);
  return count >= options_.least && line.to - line.from >= options_.shortest && line.misfit <= kMostMisfit * count;
}

}  // namespace sf::estimation
