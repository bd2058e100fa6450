#include "control/own_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/plugin_calls.h"
#include "base/printable.h"
#include "base/suggest.h"
#include "control/plugin_guard.h"
#include "control/public_settings.h"
#include "sensors/derived/public_types.h"

namespace sf::control {

namespace {

static_assert(static_cast<int>(sensorfarm::LightState::flashing_yellow) ==
              static_cast<int>(world::LightState::flashing_yellow));
static_assert(sensorfarm::kNone == base::kNoHit && sensorfarm::kNone == base::kNoId);

}  // namespace

sensorfarm::Robot robot_of(const ControllerContext& context) {
  const world::Mover& mover = context.world.movers[context.mover];
  sensorfarm::Robot robot{mover.name,   mover.id,          context.row_in_copy(), sensors::public_pose(mover.X_WM),
                          mover.radius, mover.max_forward, mover.max_turn,        {},
                          context.seed, context.world.file};
  std::optional<sensors::SensorSet> made;
  const sensors::SensorSet& all = context.sensors_or(made);
  for (const sensors::SensorSet::Group& group : all.groups())
    for (const sensors::SensorSpec& spec : all.of(group.type->id, context.mover))
      robot.sensors.push_back(sensors::public_info(*group.type, spec));
  return robot;
}

namespace {

std::string own_controller_name(const ControllerContext& context) {
  return base::one_line(
      fmt::format("controller '{}' of robot '{}'", context.type->name, context.world.movers[context.mover].name));
}

class OwnController final : public Controller {
  void translate(const ControllerInput& input);
  [[nodiscard]] base::InputError failure(const std::string& why) const {
    return base::InputError(fmt::format("{} failed at {:.3f} s: {}", name_, time_, base::one_line(why)));
  }
  template <class Call>
  auto guarded(Call&& call) const {
    const base::PluginCall under_way(name_, time_);
    return guarded_call(call, [this](const char* why) { return failure(why); });
  }

 public:
  OwnController(const ControllerContext& context, std::unique_ptr<sensorfarm::Controller> inner)
      : world_(context.world),
        name_(own_controller_name(context)),
        inner_(std::move(inner)),
        range_(guarded([&] { return inner_->radio_range(); })),
        needs_(read_needs()) {}

  ~OwnController() override {
    const base::PluginCall under_way(name_, time_);
    inner_.reset();
  }
  OwnController(const OwnController&) = delete;
  OwnController& operator=(const OwnController&) = delete;

  base::Twist step(const ControllerInput& input) override;
  base::Intent intent() const override { return {}; }
  double v2v_range() const override { return range_; }
  std::uint64_t needs() const override { return needs_; }
  bool done() const override {
    return guarded([&] { return inner_->done(); });
  }
  double error() const override {
    return guarded([&] { return inner_->error(); });
  }
  std::uint8_t outputs() const override {
    return guarded([&] { return inner_->outputs(); });
  }

 private:
  [[noreturn]] void refuse_type(const std::string& name) const;
  std::uint64_t read_needs() const;

  const world::World& world_;
  std::string name_;  ///< "controller 'mine' of robot 'r0'"
  std::unique_ptr<sensorfarm::Controller> inner_;
  double time_ = 0.0;  ///< [s] of the last step
  double range_;
  std::uint64_t needs_;
  std::vector<sensorfarm::Reading> readings_;
  std::vector<sensorfarm::Neighbour> others_;
  std::vector<sensorfarm::Light> lights_;
};

void OwnController::refuse_type(const std::string& name) const {
  std::vector<std::string_view> known;
  for (const sensors::SensorType* type : sensors::sensor_types()) known.push_back(type->name);
  throw base::InputError(fmt::format("{}: sufficient_sensors() returned the unknown sensor type '{}'{}", name_,
                                     base::one_line(name), base::expected_one_of(name, known)));
}

std::uint64_t OwnController::read_needs() const {
  const auto names = guarded([&] { return inner_->sufficient_sensors(); });
  if (!names) return kNeedsFarm;
  std::uint64_t needs = 0;
  for (const std::string& name : *names) {
    const auto all = sensors::sensor_types();
    const auto type = std::find_if(all.begin(), all.end(), [&](const auto* each) { return each->name == name; });
    if (type == all.end()) refuse_type(name);
    needs |= std::uint64_t{1} << (*type)->id;
  }
  return needs;
}

void OwnController::translate(const ControllerInput& input) {
  readings_.clear(), others_.clear(), lights_.clear();
  for (const base::ReadingBlock& r : input.readings)
    readings_.push_back(sensors::public_reading(r, *sensors::find_sensor_type(r.type)));
  for (const Neighbour& other : input.others)
    others_.push_back({other.id, sensors::public_pose(other.state.X_WM), sensors::public_twist(other.state.velocity),
                       other.intent.follows});
  for (std::size_t i = 0; i < input.signals.size(); ++i)
    lights_.push_back({world_.lights[i].name, sensors::public_pose(world_.lights[i].X_WL),
                       static_cast<sensorfarm::LightState>(input.signals[i].state), input.signals[i].left});
}

base::Twist OwnController::step(const ControllerInput& input) {
  time_ = 1e-9 * static_cast<double>(input.time);
  translate(input);
  const sensorfarm::Twist twist = guarded([&] {
    return inner_->step({time_, sensors::public_pose(input.state.X_WM), sensors::public_twist(input.state.velocity),
                         readings_, input.contact, input.started, others_, lights_});
  });
  if (!std::isfinite(twist.forward) || !std::isfinite(twist.left) || !std::isfinite(twist.turn))
    throw failure(
        fmt::format("its twist is ({}, {}, {}); expected finite numbers", twist.forward, twist.left, twist.turn));
  return {twist.forward, twist.left, twist.turn};
}

}  // namespace

std::unique_ptr<Controller> make_own_controller(const ControllerContext& context, Settings& settings) {
  const sensorfarm::ControllerEntry& entry = *context.type->entry;
  PublicSettings keys(settings);
  const auto refused = [&](const char* why) {
    return base::InputError(fmt::format("controller '{}' refuses robot '{}': {}", entry.name,
                                        context.world.movers[context.mover].name, base::one_line(why)));
  };
  const base::PluginCall under_way(own_controller_name(context));
  return std::make_unique<OwnController>(context,
                                         made_by_plugin([&] { return entry.make(robot_of(context), keys); }, refused));
}

}  // namespace sf::control
