#include "scenarios/fleet_share.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "scenarios/fleet_tiles.h"
#include "scenarios/rank_exchange.h"

namespace sf::scenarios {

namespace {

/// Every rank senses its own robots in the whole world and decides for them.
class RankShare : public FleetShare {
 public:
  explicit RankShare(cluster::Ranks& ranks) : ranks_(ranks) {}

  void check_may_share_maps() const override {
    if (ranks_.size() > 1)
      throw base::InputError(
          "controller 'explore': robots cannot share maps across ranks; expected one process, or the setting "
          "'team = false'");
  }

  bool owns(std::uint32_t mover) const override { return exchange_->owns(mover); }
  void add_mover() override {
    exchange_->add_mover();
    statuses_.emplace_back();
  }
  void remove_last() override {
    exchange_->remove_last();
    statuses_.pop_back();
  }
  void set_status(std::uint32_t mover, const ControlStatus& status) override { statuses_[mover] = status; }
  const ControlStatus* status(std::uint32_t mover) const override { return &statuses_[mover]; }

  void attach(const world::World& world, farm::Farm& farm) override {
    farm_ = &farm;
    exchange_.emplace(ranks_, homes(world));
    statuses_.resize(world.movers.size());
    for (std::uint32_t i = 0; i < world.movers.size(); ++i)
      if (!owns(i)) farm.sharing().leave_to_others(i);
  }
  void end_step(const FleetStep& step, const OwnOutcome& own) override {
    for (std::uint32_t m = 0; m < statuses_.size(); ++m)
      if (owns(m) && statuses_[m].drives) statuses_[m] = own.status(m);
    exchange_->begin(decisions(step), *farm_, own.failed, own.failure, stop_);
    exchanging_ = true;
  }
  void finish_step(const FleetStep& step) override {
    if (std::exchange(exchanging_, false)) stop_agreed_ = exchange_->finish(decisions(step), *farm_);
  }
  void request_stop() override { stop_ = true; }
  bool stop_agreed() const override { return stop_agreed_; }

 protected:
  virtual std::vector<unsigned> homes(const world::World& world) const {
    return equal_homes(costs_of(world, farm_->sensor_set()), ranks_.size());
  }
  farm::Farm& farm() { return *farm_; }

 private:
  FleetDecisions decisions(const FleetStep& step) { return {step.commands, step.intents, step.estimates, statuses_}; }

  cluster::Ranks& ranks_;
  farm::Farm* farm_ = nullptr;
  std::optional<RankExchange> exchange_;  ///< set by `attach`
  std::vector<ControlStatus> statuses_;   ///< per mover
  bool exchanging_ = false;
  bool stop_ = false, stop_agreed_ = false;
};

/// Every rank moves and senses the robots in its tile, and decides for those that started there.
class TileShare final : public RankShare {
 public:
  TileShare(const world::World& world, const ShareOptions& options)
      : RankShare(*options.ranks), tiles_(*options.ranks, world), starts_unchecked_(!world.unread.empty()) {
    if (options.balance > 0.0) {
      const double ticks = std::round(options.balance / world.interval);
      balance_ = static_cast<std::uint64_t>(std::max(2.0, ticks));
    } else {
      part_ = world;
      tiles_.keep_own_part(*part_);
    }
  }

  const world::World& part_of(const world::World& whole) const override { return part_ ? *part_ : whole; }
  void check_may_join() const override {
    throw base::InputError("robots cannot join or leave a run with --tiles; expected ranks that share the whole world");
  }
  void begin(robots::Fleet& fleet, std::span<double> v2v_ranges) override { tiles_.begin(fleet, farm(), v2v_ranges); }
  void begin_step(std::uint64_t tick) override {
    if (balance_ == 0 || tick == 0 || tick % balance_ != 0) return;
    const double sensing_s = farm().stats().sensing_s();
    tiles_.cut_anew(sensing_s - std::exchange(balanced_s_, sensing_s));
  }
  void after_motion(bool radio) override {
    tiles_.share_states();
    if (radio) tiles_.share_neighbours();
  }
  std::optional<std::span<const base::Report>> remote_neighbours(std::uint32_t mover) const override {
    if (tiles_.measures(mover)) return std::nullopt;
    return tiles_.neighbours(mover);
  }
  bool knows(std::uint32_t mover) const override { return tiles_.present(mover); }
  std::optional<std::uint64_t> passed_on() const override { return tiles_.passed_on(); }
  std::vector<world::Warning> warnings_of_starts() override {
    return starts_unchecked_ ? tiles_.warnings_of_starts(part_.value()) : std::vector<world::Warning>();
  }

 private:
  std::vector<unsigned> homes(const world::World&) const override {
    return {tiles_.homes().begin(), tiles_.homes().end()};
  }

  FleetTiles tiles_;
  std::optional<world::World> part_;  ///< of this rank's tile; nullopt: tiles change, and every rank has all walls
  bool starts_unchecked_;             ///< the walls were not available at load
  std::uint64_t balance_ = 0;         ///< ticks between repartitions of the tiles; 0: fixed tiles
  double balanced_s_ = 0.0;           ///< [s] of sensing up to the last repartition
};

}  // namespace

std::unique_ptr<FleetShare> make_fleet_share(const world::World& world, const ShareOptions& options) {
  if (options.ranks == nullptr) return std::make_unique<FleetShare>();
  if (options.tiles) return std::make_unique<TileShare>(world, options);
  return std::make_unique<RankShare>(*options.ranks);
}

}  // namespace sf::scenarios
