#include "control/model_controllers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/plugin_calls.h"
#include "base/printable.h"
#include "base/random.h"
#include "base/suggest.h"
#include "control/controllers.h"
#include "control/own_controllers.h"
#include "control/plugin_guard.h"
#include "control/public_settings.h"
#include "sensorfarm/model.h"
#include "sensors/derived/public_types.h"

namespace sf::control {

namespace {

constexpr double kFarthestModel = 1e7;  // [m] per coordinate, as for reported states
constexpr double kLongestRange = 1e3;   // [m]

}  // namespace

/// One model and its controller.
struct ModelControllers::Controlled {
  std::uint32_t mover = 0;
  std::string name;  ///< "controller 'door' of model 'gate'"
  std::unique_ptr<sensorfarm::ModelController> controller;
  double range = 0.0;                  ///< [m]
  double time = 0.0;                   ///< [s] of the last call
  std::uint64_t draws = 0;             ///< random numbers drawn so far
  std::vector<std::uint32_t> touched;  ///< models in contact at the last call, ascending

  ~Controlled() {
    const base::PluginCall under_way(name, time);
    controller.reset();
  }

  /// Calls users' code. Its exceptions become errors.
  template <class Call>
  auto guarded(Call&& call) const {
    const auto fail = [&](const char* why) -> base::InputError {
      return base::InputError(fmt::format("{} failed at {:.3f} s: {}", name, time, base::one_line(why)));
    };
    const base::PluginCall under_way(name, time);
    return guarded_call(call, fail);
  }
};

/// An object as a controller sees it. `Interface`: WorldObject or Model of sensorfarm/model.h
template <class Interface>
class ModelControllers::Handle : public Interface {
 public:
  Handle(ModelControllers& all, std::uint32_t mover, const Scene& scene) : all_(all), mover_(mover), scene_(scene) {}

  sensorfarm::Pose pose() const override { return sensors::public_pose(scene_.states[mover_].X_WM); }
  sensorfarm::Twist velocity() const override { return sensors::public_twist(scene_.states[mover_].velocity); }
  bool present() const override { return !scene_.absent[mover_]; }
  bool changeable() const override { return !all_.is_taken(mover_); }

  void set_pose(const sensorfarm::Pose& pose) override {
    for (const double place : {pose.x, pose.y, pose.z})
      if (!(std::abs(place) <= kFarthestModel) || !std::isfinite(pose.yaw))
        throw std::invalid_argument(
            fmt::format("set_pose({}, {}, {}, {}): expected finite numbers, and x, y and z within {:g} m", pose.x,
                        pose.y, pose.z, pose.yaw, kFarthestModel));
    change().X_WM = {pose.x, pose.y, pose.z, pose.yaw};
    change().velocity = base::Twist{};
  }
  void set_velocity(const sensorfarm::Twist& twist) override {
    if (!std::isfinite(twist.forward) || !std::isfinite(twist.left) || !std::isfinite(twist.turn))
      throw std::invalid_argument(
          fmt::format("set_velocity({}, {}, {}): expected finite numbers", twist.forward, twist.left, twist.turn));
    change().velocity = base::Twist{twist.forward, twist.left, twist.turn};
  }
  void set_present(bool wanted) override {
    change().present = wanted;
    if (wanted != present()) change().velocity = base::Twist{};
  }

  void set_shape(std::string_view name) override { reshape({.shape = std::string(name)}); }
  void set_size(double x, double y, double z) override { reshape({.size = glm::dvec3{x, y, z}}); }
  void set_color(std::string_view color) override { reshape({.color = world::color_named(std::string(color))}); }

 protected:
  ModelControllers& all_;
  std::uint32_t mover_;
  const Scene& scene_;

 private:
  Change& change() { return all_.change_of(mover_); }
  void reshape(const world::ShapeChange& wanted) {
    if (!scene_.shapes_change)
      throw std::runtime_error("shape, size and colour cannot change here; expected a run, a scenario or the library");
    world::ShapeChange all = change().shape;
    all.add(wanted);
    world::check_change(all_.world_, mover_, all);
    change().shape = std::move(all);
  }
};

/// The model as its controller sees it.
class ModelControllers::ModelHandle final : public Handle<sensorfarm::Model> {
 public:
  ModelHandle(ModelControllers& all, Controlled& model, const Scene& scene)
      : Handle(all, model.mover, scene), model_(model) {}

  double time() const override { return model_.time; }
  std::span<const sensorfarm::NearRobot> robots() const override { return all_.robots_; }
  sensorfarm::WorldObject& object(std::string_view name) override {
    const std::uint32_t row = all_.object_named(name);
    if (row == mover_) return *this;
    return others_.try_emplace(row, all_, row, scene_).first->second;
  }
  double uniform() override { return base::random_uniform(next_draw(), 0)[0]; }
  double normal() override { return base::random_normal(next_draw(), 0)[0]; }

 private:
  base::RandomKey next_draw() {
    return {all_.options_.seed, base::RandomStream::decision, mover_, 0x6D6F646Cu, model_.draws++};
  }

  Controlled& model_;
  std::map<std::uint32_t, Handle<sensorfarm::WorldObject>> others_;  ///< by row
};

namespace {

sensorfarm::ModelSite site_of(const world::World& world, std::uint32_t row, const ModelControllers::Options& options) {
  const world::Mover& mover = world.movers[row];
  return {mover.name,
          row,
          sensors::public_pose(mover.X_WM),
          mover.radius,
          mover.max_forward,
          mover.max_turn,
          options.interval,
          options.seed,
          world.file};
}

std::unique_ptr<sensorfarm::ModelController> make_model_controller(const sensorfarm::ModelEntry& entry,
                                                                   const sensorfarm::ModelSite& site,
                                                                   sensorfarm::Settings& settings) {
  const auto refused = [&](const char* why) {
    return base::InputError(
        fmt::format("controller '{}' refuses model '{}': {}", entry.name, site.name, base::one_line(why)));
  };
  return made_by_plugin([&] { return entry.make(site, settings); }, refused);
}

}  // namespace

std::vector<std::uint32_t> controlled_models(const world::World& world) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (world.movers[row].is_tag && !world.movers[row].controller.empty()) rows.push_back(row);
  return rows;
}

ModelControllers::ModelControllers(const world::World& world, std::span<const std::uint32_t> rows,
                                   const Options& options)
    : world_(world), options_(options) {
  for (const std::uint32_t row : rows) {
    const world::Mover& mover = world.movers[row];
    with_place(mover.controller_at, [&] {
      const sensorfarm::ModelEntry& entry = find_model_controller(mover.controller);
      auto model = std::make_unique<Controlled>();
      model->mover = row;
      model->name = base::one_line(fmt::format("controller '{}' of model '{}'", entry.name, mover.name));
      Settings settings = settings_of_ctrl(mover);
      {
        const base::PluginCall under_way(model->name);
        PublicSettings keys(settings);
        model->controller = make_model_controller(entry, site_of(world, row, options), keys);
      }
      settings.require_all_read();
      model->range = model->guarded([&] { return model->controller->range(); });
      if (!(model->range >= 0.0 && model->range <= kLongestRange))
        throw base::InputError(
            fmt::format("{} has a range of {} m; expected 0 to {:g}", model->name, model->range, kLongestRange));
      models_.push_back(std::move(model));
      change_of(row).velocity = base::Twist{};
    });
  }
}

ModelControllers::~ModelControllers() = default;

bool ModelControllers::remove(std::uint32_t mover) {
  if (is_taken(mover)) return false;
  if (taken_.size() <= mover) taken_.resize(mover + 1, false);
  taken_[mover] = true;
  requested_.erase(mover);
  return std::erase_if(models_, [&](const auto& model) { return model->mover == mover; }) > 0;
}

/// Returns the requests for a mover in this tick; for one that is taken, a place for requests without effect.
ModelControllers::Change& ModelControllers::change_of(std::uint32_t mover) {
  if (is_taken(mover)) return ignored_ = {.mover = mover};
  return requested_.try_emplace(mover, Change{.mover = mover}).first->second;
}

/// @throws std::invalid_argument unless the name is that of a mover that is not a robot
std::uint32_t ModelControllers::object_named(std::string_view name) {
  for (std::size_t row = named_.size(); row < world_.movers.size(); ++row)
    named_.emplace(world_.movers[row].name, static_cast<std::uint32_t>(row));
  const auto found = named_.find(name);
  if (found != named_.end() && world_.movers[found->second].is_tag) return found->second;
  if (found != named_.end())
    throw std::invalid_argument(fmt::format("'{}' is a robot; expected an object: models cannot move robots", name));
  std::vector<std::string_view> names;
  for (const world::Mover& mover : world_.movers)
    if (mover.is_tag) names.push_back(mover.name);
  throw std::invalid_argument(
      fmt::format("there is no object '{}' that moves{}", name,
                  base::suggest(name, names, "expected a model named tag<N>, or one with ctrl")));
}

std::span<const ModelControllers::Change> ModelControllers::call(const Scene& scene) {
  changes_.clear();
  if (models_.empty()) return {};
  double reach = 0.0;
  for (const world::Mover& mover : world_.movers) widest_ = std::max(widest_, mover.radius);
  for (const auto& model : models_) reach = std::max({reach, model->range, 2.0 * widest_});
  grid_.build(scene.states, 2.0 * reach + 1e-3);
  for (auto& [row, change] : requested_) change = {.mover = row, .velocity = change.velocity};
  for (const auto& model : models_) call_one(*model, scene);
  for (const auto& [row, change] : requested_) changes_.push_back(change);
  return changes_;
}

/// Sets `near_` and `robots_`.
void ModelControllers::find_near(const Controlled& model, const Scene& scene) {
  const base::Pose& X_WM = scene.states[model.mover].X_WM;
  const double touching = world_.movers[model.mover].radius + widest_ + robots::kContactDistance;
  near_.clear(), robots_.clear();
  grid_.any({X_WM.x, X_WM.y}, std::max(model.range, touching), [&](std::uint32_t row) {
    if (row != model.mover && !scene.absent[row]) near_.push_back(row);
    return false;
  });
  std::sort(near_.begin(), near_.end());
  for (const std::uint32_t row : near_) {
    const world::Mover& robot = world_.movers[row];
    const base::Report& state = scene.states[row];
    const double distance = glm::length(glm::dvec2{state.X_WM.x - X_WM.x, state.X_WM.y - X_WM.y});
    if (!robot.is_tag && distance <= model.range)
      robots_.push_back({robot.name, row, sensors::public_pose(state.X_WM), sensors::public_twist(state.velocity),
                         robot.radius, distance});
  }
  const auto order = [](const sensorfarm::NearRobot& robot) { return std::tuple(robot.distance, robot.row); };
  std::sort(robots_.begin(), robots_.end(), [&](const auto& p, const auto& q) { return order(p) < order(q); });
  if (robots_.size() > sensorfarm::kMostNearRobots) robots_.resize(sensorfarm::kMostNearRobots);
}

void ModelControllers::call_one(Controlled& model, const Scene& scene) {
  find_near(model, scene);
  model.time = 1e-9 * static_cast<double>(scene.time);
  ModelHandle handle(*this, model, scene);
  touches_.clear();
  if (handle.present()) scene.fleet.find_touches(model.mover, scene.states, near_, touches_);
  call_contacts(model, handle);
  model.guarded([&] { model.controller->tick(handle); });
}

/// Reports the contacts in `touches_` that the last call did not have.
void ModelControllers::call_contacts(Controlled& model, ModelHandle& handle) {
  const auto by_model = [](const auto& p, const auto& q) { return p.model < q.model; };
  std::sort(touches_.begin(), touches_.end(), by_model);
  for (const robots::Fleet::Touch& touch : touches_) {
    if (std::binary_search(model.touched.begin(), model.touched.end(), touch.model)) continue;
    const bool moves = touch.mover != world::kNone;
    const sensorfarm::ModelContact contact{world_.models[touch.model].name, touch.mover,
                                           moves && !world_.movers[touch.mover].is_tag, touch.p.x, touch.p.y};
    model.guarded([&] { model.controller->contact(contact, handle); });
  }
  model.touched.clear();
  for (const robots::Fleet::Touch& touch : touches_) model.touched.push_back(touch.model);
}

}  // namespace sf::control
