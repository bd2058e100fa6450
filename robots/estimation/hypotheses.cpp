#include "robots/estimation/hypotheses.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::estimation {

namespace {

constexpr double kCertain = 0.05;      // [rad] within this, a path is practically linear in the errors
constexpr std::size_t kHeadings = 24;  // hypotheses for a heading that is not measured
constexpr double kLeastWeight = 1e-5;
constexpr double kFarthest = 10.0;  // [rad] exceeds any distance of headings

/// [rad] Distance of headings with `count` hypotheses. With fewer hypotheses, they can be narrower and more exact.
double heading_distance(std::size_t count) { return std::clamp(0.011 * static_cast<double>(count), 0.08, 0.26); }

bool lighter(const Hypothesis& a, const Hypothesis& b) { return a.weight < b.weight; }

/// Drops negligible hypotheses and scales the weights to sum to 1. The heaviest one comes first.
void normalise(Hypotheses& all) {
  std::iter_swap(all.begin(), std::max_element(all.begin(), all.end(), lighter));
  const double least = kLeastWeight * all[0].weight;
  all.erase(std::remove_if(all.begin() + 1, all.end(), [&](const Hypothesis& h) { return !(h.weight >= least); }),
            all.end());
  double sum = 0.0;
  for (const Hypothesis& h : all) sum += h.weight;
  for (Hypothesis& h : all) h.weight /= sum;
}

/// Merges hypotheses into heavier ones with similar headings, now and halfway since the last measurement. The latter
/// determines the path since then.
void reduce(const MotionModel& model, const HypothesesLimits& limits, Hypotheses& all) {
  normalise(all);
  const double half = 0.5e-9 * static_cast<double>(all[0].estimate.time - limits.corrected);
  for (double near = 0.77 * heading_distance(all.size()); all.size() > 1 && near < kFarthest; near *= 1.5) {
    std::size_t count = 0;
    for (auto from = all.begin(); from != all.end(); ++count) {
      std::iter_swap(from, std::max_element(from, all.end(), lighter));
      const auto is_near = [&, yaw = from->estimate.X_WM.yaw, turn = from->estimate.velocity.turn](const auto& h) {
        const double by_turn = std::min(std::abs(half * (h.estimate.velocity.turn - turn)), M_PI);
        return base::hypot(base::wrap_angle(h.estimate.X_WM.yaw - yaw), by_turn) < near;
      };
      const auto end = std::partition(from + 1, all.end(), is_near);
      all[count] = merged(model, {from, end});
      from = end;
    }
    all.resize(count);
    if (count <= limits.most) return;
  }
  // More than the limit remain only if numbers are not finite, because these are not near anything.
  all.resize(std::min(all.size(), limits.most));
  normalise(all);
}

/// Splits uncertain headings before predicting. Slightly uncertain ones are merged again at the end of the step.
void step(const MotionModel& model, std::int64_t time, const HypothesesLimits& limits, Hypotheses& all) {
  const double dt = 1e-9 * static_cast<double>(time - all[0].estimate.time);
  const double distance = heading_distance(all.size());
  const std::size_t before = all.size();
  for (std::size_t k = 0; k < before; ++k) {
    const Hypothesis whole = all[k];
    const double sigma = middle_heading_sigma(whole.estimate, dt);
    const bool wide = sigma > 1.15 * distance;
    if (!(sigma > kCertain) || std::abs(time - whole.estimate.time) > kHypothesesStep) {
      all[k].estimate = predict(model, whole.estimate, time);
      continue;
    }
    const std::size_t first = all.size();
    split(model, whole, dt, wide ? 0.77 * distance : 0.6 * sigma, all);
    for (std::size_t i = first; i < all.size(); ++i) all[i].estimate = predict(model, all[i].estimate, time);
    all[k].weight = 0.0;
    if (wide) continue;
    all[k] = merged(model, std::span(all).subspan(first));
    all.resize(first);
  }
  reduce(model, limits, all);
}

}  // namespace

void start(const MotionModel& model, const Measurement& measurement, std::size_t most, Hypotheses& all) {
  Measurement m = measurement;
  const double distance = 2.0 * M_PI / static_cast<double>(std::min(most, kHeadings)), sigma = 0.6 * distance;
  const bool measured = (m.components >> kYaw & 1u) != 0;
  if (most == 1 || (measured && m.pose_covariance[5] <= sigma * sigma)) {
    all.assign(1, {1.0, first_estimate(model, m)});
    return;
  }
  m.components &= static_cast<std::uint8_t>(~(1u << kYaw));
  all.assign(std::min(most, kHeadings),
             {1.0 / static_cast<double>(std::min(most, kHeadings)), first_estimate(model, m)});
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].estimate.X_WM.yaw = (static_cast<double>(k) + 0.5) * distance - M_PI;
    all[k].estimate.covariance[kComponents * kYaw + kYaw] = sigma * sigma;
  }
  m.components = 1u << kYaw;
  if (measured) correct(model, m, {most, m.time}, all);
}

bool has_certain_heading(const Estimate& estimate) {
  return estimate.covariance[kComponents * kYaw + kYaw] <= kCertain * kCertain;
}

void predict(const MotionModel& model, std::int64_t time, const HypothesesLimits& limits, Hypotheses& all) {
  if (all.size() == 1) {
    const Estimate to = predict(model, all[0].estimate, time);
    if (limits.most == 1 || has_certain_heading(to)) {
      all[0].estimate = to;
      return;
    }
  }
  advance(model, time, limits, all);
}

void advance(const MotionModel& model, std::int64_t time, const HypothesesLimits& limits, Hypotheses& all) {
  const std::int64_t whole = time < limits.corrected ? -kHypothesesStep : kHypothesesStep;
  const std::int64_t last = limits.corrected + kMostHypothesesSteps * whole;
  for (std::int64_t now = all[0].estimate.time; now != time; now = all[0].estimate.time)
    step(model, now != last && std::abs(time - now) > kHypothesesStep ? now + whole : time, limits, all);
}

Innovation innovation(const Hypotheses& predicted, const Measurement& measurement) {
  Innovation least{.squared = HUGE_VAL};
  for (const Hypothesis& h : predicted) {
    const Innovation each = innovation(h.estimate, measurement);
    if (each.squared < least.squared) least = each;
  }
  return least;
}

void correct(const MotionModel& model, const Measurement& measurement, const HypothesesLimits& limits,
             Hypotheses& all) {
  if (all.size() == 1) {
    Estimate& one = all[0].estimate;
    one = limits.most == 1 ? correct(one, measurement) : correct(model, one, measurement);
    return;
  }
  // Uses logarithms, since all likelihoods may underflow.
  double most = -HUGE_VAL;
  for (Hypothesis& h : all) {
    const Innovation surprise = innovation(h.estimate, measurement);
    h.weight = base::log(h.weight) - 0.5 * (surprise.squared + surprise.log_determinant);
    if (!(h.weight > -HUGE_VAL)) h.weight = -HUGE_VAL;
    most = std::max(most, h.weight);
    h.estimate = correct(model, h.estimate, measurement);
  }
  for (Hypothesis& h : all) h.weight = most > -HUGE_VAL ? base::exp(h.weight - most) : 1.0;
  reduce(model, limits, all);
}

const Estimate& most_probable(const Hypotheses& all) {
  const auto rank = [](const Hypothesis& h) { return (h.estimate.velocity.forward < 0.0 ? 0.5 : 1.0) * h.weight; };
  return std::max_element(all.begin(), all.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); })
      ->estimate;
}

Covariance covariance_about(const Estimate& state, const Hypotheses& all) {
  Covariance sum{};
  for (const Hypothesis& h : all) add_square_error(state, h, sum);
  return sum;
}

}  // namespace sf::estimation
