#include "sensors/aggregation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::string_view kChoices[] = {"first", "best", "weighted", "intersection"};
constexpr double kMostAge = 3600.0, kMostDeviation = 1e9;

bool has_covariance(const estimation::Stated& stated) { return std::isfinite(stated.covariance[0]); }
double spread(const estimation::Stated& stated) { return stated.covariance[0] + stated.covariance[2]; }

}  // namespace

AggregationSettings read_aggregation(const DerivedContext& context, double drift) {
  const world::Sensor& from = context.settings;
  for (std::size_t i = 0; i < context.inputs.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (const WiredInput& a = context.inputs[i], &b = context.inputs[k];
          a.type == b.type && a.mover == b.mover && a.sensor == b.sensor)
        refuse(from, "inputs", fmt::format("'{}' is listed twice", context.site.inputs[i].sensor.type));
  AggregationSettings settings;
  settings.choice = static_cast<Choice>(choice(from, kChooseKey, 0, kChoices));
  settings.max_age = number(from, kMaxAgeKey, settings.max_age, 1e-3, kMostAge);
  settings.drift = number(from, kDriftKey, drift, 0.0, kMostDeviation);
  settings.noise = tuple(from, kNoiseKey, 1, "[deviation ...], the standard deviation of each input")
                       .value_or(std::vector<double>{});
  std::uint32_t texts = 0;
  for (const WiredInput& input : context.inputs) texts = std::max(texts, input.place + 1);
  const bool in_range = std::ranges::all_of(settings.noise, [](double v) { return v >= 0.0 && v <= kMostDeviation; });
  if (!in_range || settings.noise.size() > texts)
    refuse(from, kNoiseKey,
           fmt::format("'noise' expects at most one standard deviation from 0 to {:g} for each of the {} inputs",
                       kMostDeviation, texts));
  settings.noise.resize(texts);
  return settings;
}

std::vector<std::uint32_t> places_of(std::span<const WiredInput> inputs) {
  std::vector<std::uint32_t> places;
  for (const WiredInput& input : inputs) places.push_back(input.place);
  return places;
}

void require_errors(const DerivedContext& context, const AggregationSettings& settings,
                    const std::function<bool(std::size_t)>& states) {
  if (settings.choice == Choice::first) return;
  for (std::size_t i = 0; i < context.inputs.size(); ++i)
    if (!states(i) && settings.noise[context.inputs[i].place] == 0.0)
      refuse(
          context.settings, "inputs",
          fmt::format("choose \"{}\" needs the error of each input; '{}' (number {}) states none: give it in 'noise', "
                      "or choose \"first\"",
                      kChoices[static_cast<std::size_t>(settings.choice)], context.site.inputs[i].sensor.type,
                      context.inputs[i].place + 1));
}

void Aggregation::take(std::size_t value, double time, const std::optional<estimation::Stated>& stated) {
  Newest& newest = newest_[value];
  if (time < newest.time) return;
  newest = {time, stated.value_or(estimation::Stated{{NAN, NAN}})};
}

std::optional<Aggregate> Aggregation::of(std::size_t value, double time) const {
  const Newest& newest = newest_[value];
  const double age = time - newest.time;
  if (!(age <= settings_.max_age) || std::isnan(newest.stated.value.x)) return std::nullopt;
  Aggregate now{newest.stated, static_cast<double>(places_[value]), age};
  const double moved = settings_.drift * settings_.drift * age * age;
  now.estimate.covariance[0] += moved;
  now.estimate.covariance[2] += moved;
  return now;
}

std::optional<Aggregate> Aggregation::at(double time) {
  fresh_.clear();
  std::optional<Aggregate> chosen;
  double oldest = 0.0;
  for (std::size_t i = 0; i < newest_.size(); ++i) {
    const std::optional<Aggregate> now = of(i, time);
    if (!now || (settings_.choice != Choice::first && !has_covariance(now->estimate))) continue;
    const bool better = settings_.choice == Choice::first ? !chosen || now->source < chosen->source
                                                          : !chosen || spread(now->estimate) < spread(chosen->estimate);
    if (better) chosen = now;
    fresh_.push_back(now->estimate);
    oldest = std::max(oldest, now->age);
  }
  if (fresh_.size() < 2 || settings_.choice <= Choice::best) return chosen;
  const bool independent = settings_.choice == Choice::weighted;
  return Aggregate{independent ? estimation::fuse_independent(fresh_) : estimation::fuse_correlated(fresh_), -1.0,
                   oldest};
}

}  // namespace sf::sensors
