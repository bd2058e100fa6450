#include "server/lane_service.h"

#include <fmt/format.h>

#include <utility>

#include "base/error.h"
#include "netio/rate_limited_log.h"
#include "server/state_receiver.h"
#include "world/roads/roads.h"

namespace sf::server {

namespace {

std::optional<std::uint32_t> lane_row(const world::RoadNetwork& roads, std::uint32_t segment, std::uint32_t lane) {
  for (std::uint32_t row = 0; row < roads.lanes.size(); ++row)
    if (roads.segments[roads.lanes[row].segment].id == static_cast<int>(segment) &&
        roads.lanes[row].number == static_cast<int>(lane))
      return row;
  return std::nullopt;
}

world::LaneUse lane_use(const netio::Lane& lane) {
  return {static_cast<world::LaneUse::Rule>(lane.rule), lane.reversed};
}

}  // namespace

LaneService::LaneService(const world::World& world) : file_(world.file), roads_(world::roads_of(world)) {}

void LaneService::accept(const netio::Lane& lane) {
  const std::pair key(lane.segment, lane.lane);
  const bool fits = requests_.size() < kMostLanes || requests_.contains(key);
  if (fits) requests_[key] = lane_use(lane);
  left_out_ += fits ? 0 : 1;
}

std::span<const world::LaneUse> LaneService::uses() const {
  return control_ ? control_->uses() : std::span<const world::LaneUse>();
}

/// Each request on its own, in order of lanes from the last one on: one that is refused leaves the others.
void LaneService::apply(std::int64_t now, netio::RateLimitedLog& log) {
  for (std::size_t tried = 0; tried < kMostTried && !requests_.empty();) {
    auto next = requests_.upper_bound(last_);
    if (next == requests_.end()) next = requests_.begin();
    const auto [key, use] = *next;
    last_ = key;
    requests_.erase(next);
    const std::string name = fmt::format("{}.{}", key.first, key.second);
    try {
      if (!roads_) throw base::InputError(file_, 0, "has no road network");
      const std::uint32_t row = lane_named(*roads_, name);
      if (changed_.size() == kMostLanes && !changed_.contains(row))
        throw base::InputError(fmt::format("the uses of {} lanes have changed, which is the most", kMostLanes));
      if (!control_) control_.emplace(*roads_);
      if (control_->wanted(row) == use) continue;
      ++tried;
      control_->request(row, use);
      changed_.insert(row);
    } catch (const base::InputError& error) {
      ++refused_;
      log.write(fmt::format("LANE {}: '{}' is refused: {}", name, lane_use_name(use), error.what()), now);
    }
  }
  if (left_out_ > 0)
    log.write(fmt::format("{} LANE for more than {} lanes in one tick are left out", left_out_, kMostLanes), now);
  refused_ += std::exchange(left_out_, 0);
}

void LaneService::update(std::int64_t now, std::span<const base::Report> states, const std::vector<bool>& absent,
                         netio::RateLimitedLog& log) {
  apply(now, log);
  if (!control_) return;
  present_.clear();
  for (const base::Report& state : states)
    if (!absent[state.mover]) present_.push_back(state);
  const std::vector<world::LaneUse> before(control_->uses().begin(), control_->uses().end());
  if (!control_->update(now, present_)) return;
  news_ = true;
  for (const std::uint32_t row : changed_)
    if (before[row] != control_->uses()[row])
      log.write(
          fmt::format("lane {} is {}{}", lane_name(*roads_, roads_->lanes[row]), lane_use_name(control_->uses()[row]),
                      control_->is_clearing(row) ? " until it is empty, then it changes its direction" : ""),
          now);
}

void LaneService::publish(std::int64_t now, StateReceiver& receiver) {
  if (!control_ || (!news_ && published_ && now - *published_ < kPeriod)) return;
  published_ = now;
  news_ = false;
  for (const auto& [id, mover] : receiver.robots()) {
    if (!receiver.inbox().wants_neighbours(id, now)) continue;
    for (const std::uint32_t row : changed_) {
      const world::RoadLane& lane = roads_->lanes[row];
      const world::LaneUse& use = control_->uses()[row];
      netio::encode(
          {.robot = static_cast<std::uint16_t>(id), .sequence = sent_[id]++, .time = now},
          netio::Lane{static_cast<std::uint32_t>(roads_->segments[lane.segment].id),
                      static_cast<std::uint32_t>(lane.number), static_cast<std::uint32_t>(use.rule), use.reversed},
          packet_);
      receiver.queue(id, packet_);
    }
  }
}

ReceivedLanes::ReceivedLanes(const world::RoadNetwork* roads)
    : roads_(roads), uses_(roads != nullptr ? roads->lanes.size() : 0) {}

bool ReceivedLanes::take(const netio::Lane& lane) {
  const auto row = roads_ != nullptr ? lane_row(*roads_, lane.segment, lane.lane) : std::nullopt;
  if (!row) return false;
  if (uses_[*row] == lane_use(lane)) return true;
  std::vector<world::LaneUse> uses = uses_;
  uses[*row] = lane_use(lane);
  try {
    // Other lanes may get their new uses by the next packets.
    network_ = std::make_shared<const world::RoadNetwork>(with_uses(*roads_, uses, true));
  } catch (const base::InputError&) {
    return false;
  }
  uses_ = std::move(uses);
  return true;
}

}  // namespace sf::server
