#include "farm/derivation.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/error.h"

namespace sf::farm {

Derivation::Derivation(const sensors::SensorContext& context, const sensors::SensorSet& sensor_set)
    : sensor_set_(sensor_set), sensors_(context.world, sensor_set, context.thread_pool, context.episodes) {
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    if (group.type->derived != nullptr) pipelines_.emplace_back(context, group);
  if (!empty()) delivered_.reserve(sensor_set.count());
}

void Derivation::go_on(Derivation& before, std::int64_t last_tick, std::int64_t last_call) {
  for (SensorPipeline& pipeline : pipelines_) {
    const auto same = [&](const SensorPipeline& other) { return other.group->type == pipeline.group->type; };
    const auto old = std::ranges::find_if(before.pipelines_, same);
    pipeline.go_on(old == before.pipelines_.end() ? nullptr : &*old, last_tick, last_call);
  }
  sensors_.take_over(before.sensors_);
}

void Derivation::restart(std::uint32_t first, std::uint32_t end) {
  for (SensorPipeline& pipeline : pipelines_) pipeline.restart(first, end);
  sensors_.restart(first, end);
}

void Derivation::require_own_inputs(const world::World& world) const {
  for (const sensors::DerivedNode& node : sensors_.nodes())
    for (const sensors::WiredInput& input : node.inputs)
      if (input.mover != node.spec.mover)
        throw base::InputError(
            node.settings->file, node.settings->line,
            fmt::format("{} has inputs of other robots, which several processes cannot share: run it "
                        "in one process",
                        sensors::derived_name(world, node)));
}

void Derivation::update_demand(std::span<const base::SensorTypes> subscribed, std::span<SensorPipeline> measured,
                               std::span<const std::uint8_t> gone) {
  sensors_.want(subscribed, gone);
  if (measured.empty()) return;
  for (const std::span<SensorPipeline> pipelines : {measured, std::span(pipelines_)})
    for (SensorPipeline& pipeline : pipelines)
      pipeline.needed = sensors_.needed(static_cast<std::size_t>(pipeline.group - sensor_set_.groups().data()));
}

void Derivation::request(std::uint32_t mover, std::uint8_t type, std::uint32_t sensor,
                         std::span<SensorPipeline> measured) {
  sensors_.want_only(mover, type, sensor);
  for (const std::span<SensorPipeline> pipelines : {measured, std::span(pipelines_)})
    for (SensorPipeline& pipeline : pipelines) {
      pipeline.due.clear();
      const auto& rows = pipeline.group->rows;
      const auto needed = sensors_.needed(static_cast<std::size_t>(pipeline.group - sensor_set_.groups().data()));
      for (std::uint32_t row = 0; row < rows.size(); ++row) {
        const bool is_it = pipeline.group->type->id == type && rows[row].mover == mover && rows[row].sensor == sensor;
        if (is_it || (!needed.empty() && needed[row] != 0)) pipeline.due.push_back({row, 0});
      }
    }
}

std::uint64_t Derivation::find_due(std::int64_t now, std::span<const base::SensorTypes> subscribed) {
  std::uint64_t missed = 0;
  for (SensorPipeline& pipeline : pipelines_) missed += pipeline.find_due(now, subscribed);
  return missed;
}

std::int64_t Derivation::next_due(std::span<const base::SensorTypes> subscribed) const {
  std::int64_t soonest = kNever;
  for (const SensorPipeline& pipeline : pipelines_) soonest = std::min(soonest, pipeline.next_due(subscribed));
  return soonest;
}

std::span<const base::ReadingBlock> Derivation::evaluate(std::int64_t now,
                                                         std::span<const base::ReadingBlock> delivered,
                                                         std::span<const base::Report> states,
                                                         const sensors::DerivedSensors::Stage& stage) {
  due_.clear();
  for (const SensorPipeline& pipeline : pipelines_) due_.emplace_back(pipeline.due);
  const auto derived = sensors_.evaluate(now, delivered, due_, states, stage, std::exchange(commands_, {}),
                                         std::exchange(received_, {}));
  delivered_.assign(delivered.begin(), delivered.end());
  delivered_.insert(delivered_.end(), derived.begin(), derived.end());
  return delivered_;
}

std::span<const base::ReadingBlock> Derivation::derive(std::int64_t now, std::span<const base::ReadingBlock> delivered,
                                                       std::span<const base::Report> states, Faults& faults,
                                                       Delivery& delivery,
                                                       std::span<const base::SensorTypes> subscribed) {
  const std::size_t known = delivered.size();
  using Fate = sensors::DerivedSensors::Fate;
  const auto all = evaluate(now, delivered, states, [&](base::ReadingBlock& reading) {
    if (!faults.empty() && !faults.apply(reading)) return Fate::lost;
    return delivery.latency_of(reading) > 0 ? Fate::late : Fate::delivered;
  });
  const auto is_subscribed = [&](const base::ReadingBlock& block) {
    return (subscribed[block.mover] & base::only(block.type)) != 0;
  };
  std::size_t kept = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!(i >= known && delivery.hold_if_late(all[i])) && is_subscribed(all[i])) delivered_[kept++] = all[i];
  return std::span(delivered_).first(kept);
}

}  // namespace sf::farm
