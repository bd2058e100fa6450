#include "scenarios/rank_exchange.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "cluster/failure.h"
#include "cluster/shares.h"

namespace sf::scenarios {

namespace {

enum Header : std::uint8_t { kStop = 1, kFailed = 2 };
enum Present : std::uint8_t {
  kStepped = 1,
  kDone = 2,
  kError = 4,
  kIntent = 8,
  kCommand = 16,
  kLeft = 32,
  kEstimate = 64
};

/// [1/s] Rays, or the number of rays that take as long as a robot's motion and controller, and each reading.
constexpr double kPerRobot = 500.0, kPerReading = 20.0;

/// Compares bitwise: the sign of a zero matters.
bool same(const base::Twist& p, const base::Twist& q) { return std::memcmp(&p, &q, sizeof p) == 0; }
bool same(const base::Intent& p, const base::Intent& q) {
  return p.follows == q.follows && p.checkpoint == q.checkpoint && p.docking == q.docking;
}

/// An estimate changes in every step. The id of the mover and its contacts are not part of it.
void put_estimate(const OwnEstimate& estimate, base::ByteWriter& out) {
  const base::Pose& X = estimate.state.X_WM;
  const base::Twist& v = estimate.state.velocity;
  out.put(estimate.state.time);
  for (const double value : {X.x, X.y, X.z, X.yaw, v.forward, v.left, v.turn}) out.put(value);
  out.put(estimate.quality.age);
  for (const float value : estimate.quality.covariance) out.put(value);
}

OwnEstimate get_estimate(base::ByteReader& in) {
  OwnEstimate estimate;
  base::Pose& X = estimate.state.X_WM;
  base::Twist& v = estimate.state.velocity;
  estimate.state.time = in.get<std::int64_t>();
  for (double* value : {&X.x, &X.y, &X.z, &X.yaw, &v.forward, &v.left, &v.turn}) *value = in.get<double>();
  estimate.quality.stated = true;
  estimate.quality.age = in.get<std::int64_t>();
  for (float& value : estimate.quality.covariance) value = in.get<float>();
  return estimate;
}

}  // namespace

std::vector<double> costs_of(const world::World& world, const sensors::SensorSet& sensor_set) {
  std::vector<double> costs(world.movers.size(), kPerRobot);
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows) costs[row.mover] += row.rate * (kPerReading + row.elements);
  return costs;
}

std::vector<unsigned> equal_homes(std::span<const double> costs, unsigned ranks) {
  const std::vector<std::uint32_t> first = cluster::equal_shares(costs, ranks);
  std::vector<unsigned> homes;
  for (unsigned rank = 0; rank < ranks; ++rank) homes.resize(first[rank + 1], rank);
  return homes;
}

RankExchange::RankExchange(cluster::Ranks& ranks, std::span<const unsigned> homes)
    : ranks_(ranks), movers_(ranks.size()), sent_commands_(homes.size()), sent_intents_(homes.size()) {
  for (std::uint32_t m = 0; m < homes.size(); ++m) {
    owned_.push_back(homes[m] == ranks.rank());
    movers_[homes[m]].push_back(m);
  }
}

void RankExchange::add_mover() {
  const auto fewest = std::min_element(movers_.begin(), movers_.end(),
                                       [](const auto& a, const auto& b) { return a.size() < b.size(); });
  fewest->push_back(static_cast<std::uint32_t>(owned_.size()));
  owned_.push_back(static_cast<unsigned>(fewest - movers_.begin()) == ranks_.rank() ? 1 : 0);
  sent_commands_.emplace_back();
  sent_intents_.emplace_back();
}

void RankExchange::remove_last() {
  const auto row = static_cast<std::uint32_t>(owned_.size() - 1);
  for (auto& movers : movers_)
    if (!movers.empty() && movers.back() == row) movers.pop_back();
  owned_.pop_back();
  sent_commands_.pop_back();
  sent_intents_.pop_back();
}

void RankExchange::begin(const FleetDecisions& own, farm::Farm& farm, std::uint32_t failed,
                         const std::exception_ptr& failure, bool stop) {
  block_.clear();
  base::ByteWriter out(block_);
  out.put(static_cast<std::uint8_t>((stop ? kStop : 0) | (failure ? kFailed : 0)));
  if (failure) {
    std::string message;
    try {
      std::rethrow_exception(failure);
    } catch (const std::exception&) {
      out.put(static_cast<std::uint8_t>(cluster::code_of_current(message)));
    }
    out.put(failed);
    out.put_string(message);
  }
  for (const std::uint32_t m : movers_[ranks_.rank()])
    if (own.statuses[m].drives) put_mover(m, own, out);
  farm.sharing().write_hashes(block_);
  ranks_.begin(block_);
}

bool RankExchange::finish(const FleetDecisions& all, farm::Farm& farm) {
  readers_.clear();
  for (const cluster::Block block : ranks_.finish()) readers_.emplace_back(block);
  bool stop = false;
  std::uint32_t first_failed = base::kNoId;
  int code = 0;
  std::string message;
  for (unsigned rank = 0; rank < readers_.size(); ++rank) {
    base::ByteReader& in = readers_[rank];
    const auto header = in.get<std::uint8_t>();
    stop = stop || (header & kStop) != 0;
    if ((header & kFailed) != 0) {
      const int its_code = in.get<std::uint8_t>();
      const auto mover = in.get<std::uint32_t>();
      std::string text = in.get_string();
      if (mover < first_failed) first_failed = mover, code = its_code, message = std::move(text);
    }
    for (const std::uint32_t m : movers_[rank])
      if (all.statuses[m].drives) get_mover(m, all, in);
    SF_CHECK(in.good(), "the decisions of rank " + std::to_string(rank) + " end early");
  }
  if (code != 0) throw cluster::Failure(code, message);
  if (ranks_.rank() == 0) farm.sharing().add_hashes(readers_);
  return stop;
}

void RankExchange::put_mover(std::uint32_t mover, const FleetDecisions& own, base::ByteWriter& out) {
  const ControlStatus& status = own.statuses[mover];
  const base::Twist& command = own.commands[mover];
  const base::Intent& intent = own.intents[mover];
  const bool error = status.stepped && std::isfinite(status.error);
  const bool new_intent = !same(intent, sent_intents_[mover]);
  const bool new_command = !same(command, sent_commands_[mover]);
  const bool left = command.left != 0.0 || std::signbit(command.left);
  const OwnEstimate& estimate = own.estimates[mover];
  const bool new_estimate = status.stepped && estimate.quality.stated;
  out.put(static_cast<std::uint8_t>((status.stepped ? kStepped : 0) | (status.done ? kDone : 0) | (error ? kError : 0) |
                                    (new_intent ? kIntent : 0) | (new_command ? kCommand : 0) | (left ? kLeft : 0) |
                                    (new_estimate ? kEstimate : 0)));
  if (error) out.put(status.error);
  if (new_intent) {
    out.put(intent.follows);
    out.put(intent.checkpoint);
    out.put(static_cast<std::uint8_t>(intent.docking));
  }
  if (new_estimate) put_estimate(estimate, out);
  if (!new_command) return;
  out.put(command.forward);
  if (left) out.put(command.left);
  out.put(command.turn);
}

void RankExchange::get_mover(std::uint32_t mover, const FleetDecisions& all, base::ByteReader& in) {
  const auto present = in.get<std::uint8_t>();
  ControlStatus& status = all.statuses[mover];
  status.stepped = (present & kStepped) != 0;
  status.done = (present & kDone) != 0;
  status.error = (present & kError) != 0 ? in.get<double>() : std::numeric_limits<double>::quiet_NaN();
  if ((present & kIntent) != 0) {
    base::Intent& intent = sent_intents_[mover];
    intent.follows = in.get<std::uint32_t>();
    intent.checkpoint = in.get<std::uint32_t>();
    intent.docking = in.get<std::uint8_t>() != 0;
  }
  if ((present & kEstimate) != 0) all.estimates[mover] = get_estimate(in);
  if ((present & kCommand) != 0) {
    base::Twist& command = sent_commands_[mover];
    command.forward = in.get<double>();
    command.left = (present & kLeft) != 0 ? in.get<double>() : 0.0;
    command.turn = in.get<double>();
  }
  all.intents[mover] = sent_intents_[mover];
  all.commands[mover] = sent_commands_[mover];
}

}  // namespace sf::scenarios
