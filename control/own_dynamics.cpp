#include "control/own_dynamics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/installation.h"
#include "base/plugin_calls.h"
#include "base/printable.h"
#include "control/own_controllers.h"
#include "control/plugin_guard.h"
#include "control/public_settings.h"
#include "sensors/derived/public_types.h"

namespace sf::control {

namespace {

constexpr std::size_t kLargestState = 4096;
constexpr double kMost = 1e7;  // [m], [rad], [m/s], [rad/s] of a state

sensorfarm::BodyState public_state(const base::Report& at) {
  return {sensors::public_pose(at.X_WM), at.tilt.roll, at.tilt.pitch, sensors::public_twist(at.velocity)};
}

class PublicGround final : public sensorfarm::Ground {
 public:
  explicit PublicGround(const world::Ground& ground) : ground_(ground) {}
  double height(double x, double y, double most) const override { return ground_.height({x, y}, most); }

 private:
  const world::Ground& ground_;
};

class OwnDynamics final : public robots::Dynamics {
  [[nodiscard]] base::InputError failure(const std::string& why) const {
    return base::InputError(fmt::format("{} failed: {}", name_, base::one_line(why)));
  }
  template <class Call>
  auto guarded(Call&& call) const {
    const base::PluginCall under_way(name_);
    return guarded_call(call, [this](const char* why) { return failure(why); });
  }

 public:
  OwnDynamics(std::string name, std::unique_ptr<sensorfarm::Dynamics> inner)
      : name_(std::move(name)), inner_(std::move(inner)), size_(guarded([&] { return inner_->state_size(); })) {
    if (size_ > kLargestState)
      throw failure(fmt::format("its state has {} elements; expected at most {}", size_, kLargestState));
  }
  ~OwnDynamics() override {
    const base::PluginCall under_way(name_);
    inner_.reset();
  }
  OwnDynamics(const OwnDynamics&) = delete;
  OwnDynamics& operator=(const OwnDynamics&) = delete;

  std::size_t state_size() const override { return size_; }
  void place(const base::Report& at, std::span<double> state) const override {
    guarded([&] { inner_->place(public_state(at), state); });
  }
  void stop(const base::Report& at, std::span<double> state) const override {
    guarded([&] { inner_->stop(public_state(at), state); });
  }
  base::Report move(const base::Report& from, const base::Twist& command, double seconds, const world::Ground& ground,
                    std::span<double> state) const override;

 private:
  std::string name_;  ///< "dynamics 'mine' of robot 'r0'"
  std::unique_ptr<sensorfarm::Dynamics> inner_;
  std::size_t size_;
};

base::Report OwnDynamics::move(const base::Report& from, const base::Twist& command, double seconds,
                               const world::Ground& ground, std::span<double> state) const {
  const sensorfarm::BodyState to = guarded([&] {
    return inner_->move(public_state(from), sensors::public_twist(command), seconds, PublicGround(ground), state);
  });
  const auto& [pose, roll, pitch, v] = to;
  const double state_of_body[] = {pose.x, pose.y, pose.z, pose.yaw, roll, pitch, v.forward, v.left, v.turn};
  if (!std::ranges::all_of(state_of_body, [](double number) { return std::abs(number) <= kMost; }))
    throw failure(fmt::format(
        "it moved to ({}, {}, {}) with yaw {}, roll {}, pitch {} and velocity ({}, {}, {}); expected numbers within "
        "{:g}",
        pose.x, pose.y, pose.z, pose.yaw, roll, pitch, v.forward, v.left, v.turn, kMost));
  base::Report report = from;
  report.X_WM = {pose.x, pose.y, pose.z, base::wrap_angle(pose.yaw)};
  report.tilt = {roll, pitch}, report.velocity = {v.forward, v.left, v.turn};
  return report;
}

robots::DynamicsPointer make_dynamics(const world::World& world, std::uint32_t row) {
  const world::Mover& mover = world.movers[row];
  const sensorfarm::DynamicsEntry& entry = find_dynamics(mover.dynamics.name);
  const std::string name = base::one_line(fmt::format("dynamics '{}' of robot '{}'", entry.name, mover.name));
  std::vector<Setting> said;
  for (const auto& [key, value] : mover.dynamics.settings) said.push_back({key, RawText{value}, ""});
  Settings settings(fmt::format("dynamics '{}'", entry.name), std::move(said));
  PublicSettings keys(settings);
  const auto refused = [&](const char* why) {
    return base::InputError(
        fmt::format("dynamics '{}' refuses robot '{}': {}", entry.name, mover.name, base::one_line(why)));
  };
  const auto copy = static_cast<std::uint32_t>(world.movers.size()) / world.copies;
  const base::PluginCall under_way(name);
  auto inner = made_by_plugin(
      [&] {
        return entry.make({mover.name, row % copy, sensors::public_pose(mover.X_WM), mover.radius, mover.max_forward,
                           mover.max_turn, mover.wheelbase, mover.track, world.file},
                          keys);
      },
      refused);
  settings.require_all_read();
  return std::make_shared<OwnDynamics>(name, std::move(inner));
}

}  // namespace

robots::DynamicsPointer make_own_dynamics(const world::World& world, std::uint32_t mover) {
  const world::DynamicsChoice& choice = world.movers[mover].dynamics;
  if (!base::names_a_plugin(choice.name)) return nullptr;
  return with_place(choice.at, [&] { return make_dynamics(world, mover); });
}

void set_own_dynamics(const world::World& world, robots::Fleet& fleet) {
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (auto dynamics = make_own_dynamics(world, row)) fleet.set_dynamics(row, std::move(dynamics));
}

}  // namespace sf::control
