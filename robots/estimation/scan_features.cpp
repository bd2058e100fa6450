#include "robots/estimation/scan_features.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/elementary.h"

namespace sf::estimation {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeastEchoSigma = 1e-3;  // [m] of echoes without noise: rounding in packets, parts of a beam
constexpr double kGrazing = 0.17;         // [rad] surfaces at smaller angles to the beams fall apart (Borges, Aldon)
constexpr double kGapSigmas = 3.0;
constexpr double kBluntest = 2.6, kSharpest = 0.5;  // [rad] angles between the arms of a corner
constexpr double kCornerGap = 0.2;                  // [m] from the end of an arm to the corner
constexpr int kTurns = 30;                          // directions of an object that are tried in a right angle
constexpr std::size_t kObjectEchoes = 3;            // fewest
constexpr double kObjectRoom = 0.5;                 // [m] by which echoes may exceed an object's size
constexpr double kLeastWidth = 0.5;                 // [-] smallest part of an object's width that is seen
constexpr double kSizeSigma = 0.08;                 // [-] standard deviation of an object's size and turn
constexpr double kObjectGap = 0.8;                  // [-] of its width, between echoes of an object
constexpr std::uint32_t kObjectBeams = 3;           // between two echoes of an object

double square_of(double value) { return value * value; }

/// The visible extent of an object along one of its axes.
struct Side {
  glm::dvec2 along;
  double low = HUGE_VAL, high = -HUGE_VAL;  ///< [m]
  void add(glm::dvec2 p) { low = std::min(low, glm::dot(p, along)), high = std::max(high, glm::dot(p, along)); }
  double width() const { return high - low; }
  double depth(glm::dvec2 p) const { return std::min(glm::dot(p, along) - low, high - glm::dot(p, along)); }
  /// [m] The middle of a side of this size, behind its end that is nearer to a sensor outside of it.
  double middle(double size, glm::dvec2 sensor) const {
    const double s = glm::dot(sensor, along);
    return s < low ? low + 0.5 * size : s > high ? high - 0.5 * size : 0.5 * (low + high);
  }
};

/// [rad] Returns the direction of a line, in (-pi/2, pi/2].
double undirected(glm::dvec2 u) {
  const double angle = base::atan2(u.y, u.x);
  return angle > 0.5 * M_PI ? angle - M_PI : angle <= -0.5 * M_PI ? angle + M_PI : angle;
}

/// Returns the upper triangle of a covariance of x, y with variances along and across a direction.
std::array<double, 6> oriented(glm::dvec2 u, double along, double across) {
  return {along * u.x * u.x + across * u.y * u.y,
          (along - across) * u.x * u.y,
          kUnknown,
          along * u.y * u.y + across * u.x * u.x,
          kUnknown,
          kUnknown};
}

}  // namespace

ScanFeatures::ScanFeatures(const base::Pose& X_MS, std::vector<double> bearings, const EchoNoise& noise,
                           const FeatureOptions& options)
    : X_MS_(X_MS), bearings_(std::move(bearings)), noise_(noise), options_(options) {
  if (bearings_.size() < 2) return;
  step_ = bearings_[1] - bearings_[0];
  // The last beam of a full turn is the first one.
  if (bearings_.back() - bearings_.front() > 2.0 * M_PI - 0.5 * step_) bearings_.pop_back();
  is_round_ = bearings_.back() - bearings_.front() > 2.0 * M_PI - 1.5 * step_;
}

void ScanFeatures::place_echoes(std::span<const double> ranges) {
  echoes_.clear();
  for (std::uint32_t i = 0; i < bearings_.size(); ++i) {
    const double range = ranges[i];
    if (!(range > 0.0 && range < 1e6)) continue;
    const glm::dvec2 sight = base::rotate(X_MS_.yaw + bearings_[i], {1.0, 0.0});
    const double along = square_of(base::hypot(noise_.constant, noise_.proportional * range, kLeastEchoSigma)) +
                         square_of(noise_.squared * range * range);
    echoes_.push_back({glm::dvec2{X_MS_.x, X_MS_.y} + range * sight, sight, along,
                       square_of(noise_.angle * range) + square_of(kLeastEchoSigma), step_ * range, i});
  }
}

/// Two neighbouring echoes are of one surface if it could be met at kGrazing, or if an object may have both.
bool ScanFeatures::continues(const Echo& before, const Echo& after) const {
  if (after.beam > before.beam && after.beam <= before.beam + kObjectBeams &&
      glm::length(after.p - before.p) < kObjectGap * options_.size.y)
    return true;
  if (after.beam != before.beam + 1 && !(is_round_ && after.beam == 0 && before.beam + 1 == bearings_.size()))
    return false;
  const double grazing = base::sin(step_) / base::sin(std::max(kGrazing - step_, 0.5 * kGrazing));
  const double range = before.spacing / step_;
  return glm::length(after.p - before.p) <= range * grazing + kGapSigmas * std::sqrt(before.along + after.along);
}

std::span<const Feature> ScanFeatures::find(std::span<const double> ranges) {
  place_echoes(ranges);
  lines_.clear(), corners_.clear(), clusters_.clear();
  // A group across the ends of a full turn begins after a gap or, without any, at the farthest echo: a corner.
  if (is_round_ && echoes_.size() > 1 && continues(echoes_.back(), echoes_.front())) {
    std::size_t start = 1;
    while (start < echoes_.size() && continues(echoes_[start - 1], echoes_[start])) ++start;
    if (start == echoes_.size())
      start = static_cast<std::size_t>(std::ranges::max_element(echoes_, {}, &Echo::spacing) - echoes_.begin());
    std::ranges::rotate(echoes_, echoes_.begin() + static_cast<std::ptrdiff_t>(start));
  }
  for (std::size_t first = 0; first < echoes_.size();) {
    std::size_t last = first;
    while (last + 1 < echoes_.size() && continues(echoes_[last], echoes_[last + 1])) ++last;
    add_group(first, last);
    first = last + 1;
  }
  found_ = lines_;
  found_.insert(found_.end(), corners_.begin(), corners_.end());
  found_.insert(found_.end(), clusters_.begin(), clusters_.end());
  return found_;
}

void ScanFeatures::add_group(std::size_t first, std::size_t last) {
  pieces_.clear();
  split(first, last);
  merge();
  for (Line& piece : pieces_)
    if (piece.is_line) trim(piece, piece.first > first, piece.last < last);
  std::size_t rest = first;  // first echo after the last line
  bool has_line = false;
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const Line& piece = pieces_[k];
    if (!piece.is_line) continue;
    // Between lines, a few echoes are those of a corner.
    if (piece.first > rest && piece.first - rest >= options_.least) add_cluster(rest, piece.first - 1);
    add_line(piece);
    has_line = true, rest = piece.last + 1;
    for (std::size_t next = k + 1; next < pieces_.size() && next <= k + 2; ++next)
      if (pieces_[next].is_line) {
        add_corner(piece, pieces_[next]);
        break;
      }
  }
  if (rest <= last && (!has_line || last - rest + 1 >= options_.least)) add_cluster(rest, last);
}

void ScanFeatures::add_line(const Line& line) {
  const double middle = 0.5 * (line.from + line.to);
  const Echo &first = echoes_[line.first], &last = echoes_[line.last];
  const glm::dvec2 u = line.along, n = left_of(u);
  const double turn = 1.0 / line.spread, across = 1.0 / line.weight + middle * middle * turn;
  // Its ends lie between the last beam that hits it and the next one.
  const double along = (first.along + last.along + (square_of(first.spacing) + square_of(last.spacing)) / 12.0) / 4.0;
  Feature feature{.kind = FeatureKind::line,
                  .p = line.centre + middle * u,
                  .direction = undirected(u),
                  .half_length = 0.5 * (line.to - line.from),
                  .covariance = oriented(u, along, across)};
  feature.covariance[2] = middle * turn * n.x, feature.covariance[4] = middle * turn * n.y;
  feature.covariance[5] = turn;
  lines_.push_back(feature);
}

void ScanFeatures::add_corner(const Line& before, const Line& after) {
  const glm::dvec2 n1 = left_of(before.along), n2 = left_of(after.along);
  const double sine = base::cross(before.along, after.along);
  const double angle = M_PI - base::acos(std::clamp(glm::dot(before.along, after.along), -1.0, 1.0));
  if (angle < kSharpest || angle > kBluntest) return;
  // n1 (p - c1) = 0 and n2 (p - c2) = 0.
  const double d1 = glm::dot(n1, before.centre), d2 = glm::dot(n2, after.centre);
  const auto solve = [&](double a, double b) {
    return glm::dvec2{(a * n2.y - b * n1.y) / sine, (b * n1.x - a * n2.x) / sine};
  };
  const glm::dvec2 p = solve(d1, d2);
  const double s1 = glm::dot(p - before.centre, before.along), s2 = glm::dot(p - after.centre, after.along);
  if (std::abs(s1 - before.to) > kCornerGap || std::abs(s2 - after.from) > kCornerGap) return;
  const double v1 = 1.0 / before.weight + s1 * s1 / before.spread, v2 = 1.0 / after.weight + s2 * s2 / after.spread;
  const glm::dvec2 g1 = solve(1.0, 0.0), g2 = solve(0.0, 1.0);
  const glm::dvec2 arms = after.along - before.along;
  Feature feature{.kind = FeatureKind::corner, .p = p, .direction = base::atan2(arms.y, arms.x)};
  // The direction is the mean of both lines' directions, up to a constant.
  const glm::dvec2 mixed = 0.5 * (s1 / before.spread * g1 + s2 / after.spread * g2);
  feature.covariance = {v1 * g1.x * g1.x + v2 * g2.x * g2.x,
                        v1 * g1.x * g1.y + v2 * g2.x * g2.y,
                        mixed.x,
                        v1 * g1.y * g1.y + v2 * g2.y * g2.y,
                        mixed.y,
                        0.25 / before.spread + 0.25 / after.spread};
  corners_.push_back(feature);
}

void ScanFeatures::add_cluster(std::size_t first, std::size_t last) {
  const Echo &a = echoes_[first], &b = echoes_[last];
  const double width = glm::length(b.p - a.p);
  if (width > options_.widest || add_object(first, last)) return;
  const double along = 0.25 * (a.along + b.along);
  const double across = 0.25 * (a.across + b.across) + (square_of(a.spacing) + square_of(b.spacing)) / 48.0;
  Feature feature{.kind = FeatureKind::cluster,
                  .p = 0.5 * (a.p + b.p),
                  .direction = kUnknown,
                  .half_length = 0.5 * (width + 0.5 * (a.spacing + b.spacing))};
  feature.covariance = oriented(glm::normalize(a.sight + b.sight), along, across);
  clusters_.push_back(feature);
}

bool ScanFeatures::add_object(std::size_t first, std::size_t last) {
  if (!(options_.size.x > 0.0) || last - first + 1 < kObjectEchoes) return false;
  const auto echoes = std::span(echoes_).subspan(first, last - first + 1);
  std::array<Side, 2> best;
  double least = HUGE_VAL;
  for (int k = 0; k < kTurns; ++k) {
    const glm::dvec2 u = base::rotate(0.5 * M_PI * k / kTurns, {1.0, 0.0});
    std::array<Side, 2> sides{Side{u}, Side{left_of(u)}};
    for (const Echo& echo : echoes) sides[0].add(echo.p), sides[1].add(echo.p);
    double sum = 0.0;
    for (const Echo& echo : echoes) sum += std::min(sides[0].depth(echo.p), sides[1].depth(echo.p));
    if (sum < least) least = sum, best = sides;
  }
  if (best[0].width() < best[1].width()) std::swap(best[0], best[1]);
  if (best[0].width() < kLeastWidth * options_.size.y) return false;
  // An extent above the object's width is along its length; otherwise the extent that fits the width better is across.
  const auto misfit = [&](const Side& side) { return std::abs(side.width() - options_.size.y); };
  if (best[0].width() <= options_.size.y + kObjectRoom && misfit(best[0]) <= misfit(best[1]))
    std::swap(best[0], best[1]);
  const auto& [length, breadth] = best;
  if (length.width() > options_.size.x + kObjectRoom || breadth.width() > options_.size.y + kObjectRoom) return false;
  // Of an object that the end of the scan cuts off, it is unknown where it ends.
  if (!is_round_ && (echoes.front().beam == 0 || echoes.back().beam + 1 == bearings_.size())) return true;
  const glm::dvec2 sensor{X_MS_.x, X_MS_.y};
  const double spacing = 0.5 * (echoes.front().spacing + echoes.back().spacing);
  const double sigma = base::hypot(kSizeSigma * options_.size.x, spacing / std::sqrt(12.0), std::sqrt(echoes[0].along));
  clusters_.push_back({.kind = FeatureKind::object,
                       .p = length.middle(options_.size.x, sensor) * length.along +
                            breadth.middle(options_.size.y, sensor) * breadth.along,
                       .direction = undirected(length.along),
                       .half_length = 0.5 * options_.size.x,
                       .covariance = {square_of(sigma), 0.0, 0.0, square_of(sigma), 0.0,
                                      square_of(kSizeSigma + spacing / options_.size.x)}});
  return true;
}

Feature cone_echo(const base::Pose& X_MC, double range, double sigma, double fov) {
  const glm::dvec2 axis = base::rotate(X_MC.yaw, {1.0, 0.0});
  // Uniform on the arc, whose depth adds to the error along the axis.
  const double half = std::min(0.5 * fov, 0.5 * M_PI);
  const double depth = range * (1.0 - base::cos(half)), width = range * base::sin(half);
  Feature feature{.kind = FeatureKind::cluster,
                  .p = glm::dvec2{X_MC.x, X_MC.y} + (range - depth / 3.0) * axis,
                  .direction = kUnknown};
  feature.covariance = oriented(axis, square_of(std::max(sigma, kLeastEchoSigma)) + square_of(depth) * 4.0 / 45.0,
                                square_of(width) / 3.0 + square_of(kLeastEchoSigma));
  return feature;
}

Feature tag_at(const base::Pose& X_MS, double range, double bearing, double orientation,
               const std::array<double, 3>& noise, std::uint32_t id) {
  const glm::dvec2 sight = base::rotate(X_MS.yaw + bearing, {1.0, 0.0});
  Feature feature{.kind = FeatureKind::tag,
                  .p = glm::dvec2{X_MS.x, X_MS.y} + range * sight,
                  .direction = base::wrap_angle(X_MS.yaw + orientation),
                  .id = id};
  feature.covariance = oriented(sight, square_of(std::max(noise[0], kLeastEchoSigma)),
                                square_of(noise[1] * range) + square_of(kLeastEchoSigma));
  feature.covariance[2] = feature.covariance[4] = 0.0;
  feature.covariance[5] = square_of(std::max(noise[2], kLeastEchoSigma));
  return feature;
}

}  // namespace sf::estimation
