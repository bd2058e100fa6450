#include "scenarios/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/elapsed.h"
#include "base/error.h"
#include "base/thread_pool.h"
#include "base/time.h"
#include "control/own_dynamics.h"
#include "control/own_localization.h"
#include "farm/schedule.h"
#include "netio/packets.h"
#include "robots/kinematics.h"
#include "sensors/derived/wiring.h"
#include "sensors/laser.h"
#include "world/append_robot.h"
#include "world/ground.h"
#include "world/roads/roads.h"

namespace sf::scenarios {

namespace {

farm::FarmOptions farm_options(const SimulationOptions& options) {
  farm::FarmOptions farm;
  farm.seed = options.seed;
  farm.threads = options.threads;
  farm.no_return_inf = options.no_return_inf;
  farm.true_poses = !options.states;
  farm.noise = options.noise;
  farm.scene.caster = options.caster;
  farm.shared = options.ranks != nullptr;
  farm.faults = options.faults;
  const auto delay = std::ranges::find(farm.faults, base::FaultKind::delay, &farm::Fault::kind);
  if (farm.shared && delay != farm.faults.end())
    throw base::InputError(delay->file, delay->line,
                           "a delay cannot be simulated by several ranks, which merge their readings in the order of "
                           "the sensors' own latencies; expected a run in one process");
  return farm;
}

/// Returns the models with a controller, except those that a robot's controller drives.
std::vector<std::uint32_t> own_models(const world::World& world, const SimulationOptions& options) {
  std::vector<std::uint32_t> rows = control::controlled_models(world);
  if (!options.actors.empty())
    std::erase_if(rows, [&](std::uint32_t row) { return !options.actors[row].controller.name.empty(); });
  if (options.ranks != nullptr && !rows.empty())
    throw base::InputError(world.movers[rows[0]].controller_at +
                           "controllers of models cannot run in several ranks; expected a run in one process");
  return rows;
}

/// Moves the newest reading of each sensor to the front, because a sensor may have several between two ticks.
std::span<base::ReadingBlock> newest_of(std::span<base::ReadingBlock> readings) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const auto newer = readings.subspan(i + 1);
    if (std::none_of(newer.begin(), newer.end(), [&](const base::ReadingBlock& r) {
          return r.type == readings[i].type && r.sensor == readings[i].sensor;
        }))
      readings[kept++] = readings[i];
  }
  return readings.first(kept);
}

}  // namespace

Simulation::Simulation(const world::World& world, gpu::Device& device, SimulationOptions options)
    : share_(make_fleet_share(world, {options.ranks, options.tiles, options.balance})),
      whole_(world),
      world_(share_->part_of(world)),
      roads_(world::roads_of(world_)),
      farm_(world_, device, farm_options(options)),
      fleet_(world_, &farm_.thread_pool()),
      models_(world_, own_models(world, options), {.seed = options.seed, .interval = world.interval}),
      commands_(world.movers.size()),
      executed_commands_(world.movers.size()),
      first_(world.movers.size() + 1),
      intents_(world.movers.size()),
      next_intents_(world.movers.size()),
      estimates_(world.movers.size()),
      next_estimates_(world.movers.size()),
      others_(farm_.thread_pool().threads()),
      own_signals_(others_.size()),
      signals_(world.lights.size()),
      light_states_(world.lights.size()),
      absent_(world.movers.size(), false),
      positioning_(options.positioning),
      actor_(options.actor),
      actors_(options.actors),
      start_at_(base::nanoseconds(options.start_at)),
      interval_(base::nanoseconds(world.interval)) {
  SF_CHECK(options.actors.empty() || options.actors.size() * world.copies == world.movers.size(),
           "actors: expected none or one per mover");
  if (world.copies > 1) refuse_copies(options);
  if (options.states) states_.emplace(world, *options.states);
  if (options.v2v && share_->passed_on())
    throw base::InputError("[v2v] cannot be simulated with --tiles; expected ranks that share the whole world");
  if (options.v2v) v2v_.emplace(*options.v2v, world.movers.size());
  farm_.subscribe_all();
  control::set_own_dynamics(world_, fleet_);
  for (const auto& [row, tilt] : options.tilts) {
    base::Report tilted = fleet_.reports()[row];
    tilted.tilt = tilt;
    fleet_.apply({&tilted, 1});
  }
  for (std::uint32_t m = 0; m < world.movers.size(); ++m)
    if (world.movers[m].absent) set_absent(m, true);
  share_->attach(world_, farm_);
  for (std::uint32_t i = 0; i < world.movers.size(); ++i) use_control(make_control(i, actor_of(i)));
  for (std::uint32_t i = 0; i < controls_.size(); ++i)
    if (controls_[i].controller) models_.remove(i);
  make_room();
  warn_of_long_ways();
  if (positioning_) camera_inputs_.add(farm_, world_, *positioning_);
  v2v_inputs_.add(farm_);
  warn_of_positioning();
}

const Actor& Simulation::actor_of(std::uint32_t mover) const {
  static const Actor none{.controller = {.name = ""}, .link = {}};
  if (!actors_.empty()) return actors_[farm_.episodes().copies().row_of(mover)];
  return world_.movers[mover].is_tag ? none : actor_;
}

/// @throws base::InputError for what several worlds cannot have
void Simulation::refuse_copies(const SimulationOptions& options) const {
  const auto is_late = [](const Actor& actor) { return !actor.link.perfect(); };
  const char* what = options.ranks != nullptr                                            ? "ranks"
                     : !options.faults.empty()                                           ? "faults of sensors"
                     : options.states                                                    ? "delayed states of robots"
                     : options.positioning                                               ? "cameras"
                     : options.v2v || !farm_.received_inputs(sensors::kV2vInput).empty() ? "a V2V link"
                     : is_late(options.actor) || std::ranges::any_of(options.actors, is_late) ? "delayed readings"
                     : !control::controlled_models(world_).empty() ? "controllers of models that are not robots"
                                                                   : nullptr;
  if (what == nullptr) return;
  throw base::InputError(world_.file, 0,
                         fmt::format("several worlds in one simulation cannot have {}; expected one world", what));
}

void Simulation::warn_of_positioning() {
  if (!positioning_ && !farm_.received_inputs(sensors::kCameraInput).empty())
    warnings_.push_back({world_.file, 0,
                         "inputs 'camera' of derived sensors receive nothing: the run has no [positioning] "
                         "(run --positioning FILE, or a scenario)"});
  if (!positioning_ || !camera_inputs_.empty()) return;
  for (std::uint32_t m = 0; m < controls_.size(); ++m)
    if (controls_[m].positioning || !share_->owns(m)) return;
  warnings_.push_back({world_.file, 0,
                       "[positioning] measures poses of robots that localize themselves, but there are none; expected "
                       "a robot with a controller and encoder( ... ), or a derived sensor with the input 'camera'"});
}

/// Warns about the first robot whose speed limits allow displacements longer than contact tests cover in a tick.
void Simulation::warn_of_long_ways() {
  for (const world::Mover& mover : world_.movers) {
    const robots::Footprint outline = robots::footprint_of(mover);
    const double way = (mover.max_forward + mover.max_turn * outline.radius) * world_.interval;
    if (outline.edges.empty() || way <= robots::Fleet::kMostTested * outline.step) continue;
    warnings_.push_back(
        {world_.file, 0,
         fmt::format("'{}' may travel {:.4g} m in a tick of {:g} s, but near obstacles a tick ends after {:.4g} m, "
                     "tested in steps of {:.2g} m; lower its velocity_bounds, or the world's interval_sim",
                     mover.name, way, world_.interval, robots::Fleet::kMostTested * outline.step, outline.step)});
    return;
  }
}

void Simulation::begin() {
  std::vector<double> ranges;
  for (const RobotControl& robot : controls_) ranges.push_back(robot.controller ? robot.controller->v2v_range() : 0.0);
  share_->begin(fleet_, ranges);
  for (const double range : ranges) v2v_range_ = std::max(v2v_range_, range);
}

void Simulation::use_control(RobotControl control) {
  if (control.controller) v2v_range_ = std::max(v2v_range_, control.controller->v2v_range());
  controls_.push_back(std::move(control));
}

/// Reserves memory for all movers and sensors, so that ticks allocate nothing.
void Simulation::make_room() {
  for (auto& others : others_) others.reserve(v2v_range_ > 0.0 ? world_.movers.size() : 0);
  const auto shares = [](const RobotControl& robot) { return robot.sharing != nullptr; };
  if (!maps_.empty() || std::any_of(controls_.begin(), controls_.end(), shares))
    for (auto* const maps : {&maps_, &next_maps_}) maps->resize(controls_.size());
  sorted_.reserve(farm_.sensor_set().count());
  next_.reserve(first_.size());
}

Simulation::RobotControl Simulation::make_control(std::uint32_t mover, const Actor& actor) {
  RobotControl robot;
  if (actor.controller.name.empty()) return robot;
  share_->set_status(mover, {.drives = true});
  if (!share_->owns(mover)) return robot;
  std::vector<world::Warning> warnings;
  const bool joins = mover >= absent_.size();  // its sensors are not in the farm yet
  std::optional<sensors::SensorSet> with_joining;
  const control::ControllerContext site{
      world_,  mover,     farm_.episodes().seed_of(mover),
      roads(), &warnings, joins ? &with_joining.emplace(world_) : &farm_.sensor_set()};
  control::ControllerConfig config = actor.controller;
  config.known_start = !positioning_ || positioning_->known_start;
  control::ConfiguredController made = control::make_controller(site, std::move(config));
  if (warnings_.empty()) warnings_ = std::move(warnings);  // robots with the same settings read the same files
  robot.controller = std::move(made.controller);
  robot.sharing = dynamic_cast<control::SharesMap*>(robot.controller.get());
  if (robot.sharing != nullptr && !robot.sharing->shares_map()) robot.sharing = nullptr;
  if (robot.sharing != nullptr) share_->check_may_share_maps();
  if (positioning_ && control::localization_of(*robot.controller) != nullptr)
    robot.positioning.emplace(*positioning_, world_.movers[mover].id);
  robot.rate = made.rate;
  robot.on_scans = made.on_scans;
  if (!(robot.on_scans && actor.link.perfect())) robot.mailbox.emplace(actor.link, world_.movers[mover].id);
  return robot;
}

bool Simulation::all_done() const {
  bool any = false;
  for (std::uint32_t m = 0; m < controls_.size() && tick_ > 0; ++m) {
    if (controls_[m].driven || absent_[m]) continue;
    const ControlStatus robot = status(m);
    if (robot.drives && !robot.done) return false;
    any = any || robot.drives;
  }
  return any;
}

base::TickRecord Simulation::step() {
  const std::int64_t time = static_cast<std::int64_t>(tick_) * interval_;
  earlier_readings_.reset();
  settle();
  if (tick_ > 0) call_models();
  take_shapes();
  if (tick_ == 0) begin();
  share_->begin_step(tick_);
  if (tick_ > 0) move();
  const auto readings = sense(time);
  const auto start = std::chrono::steady_clock::now();
  sort_by_mover(readings);
  decide(time);
  move_s_ += base::seconds_since(start);
  share_->end_step({commands_, next_intents_, next_estimates_},
                   {[this](std::uint32_t m) { return own_status(m); }, failed_, failure_});
  return {tick_++, time,   recorded_reports(), executed_commands_, fleet_.contacts(), readings, {}, light_states_,
          faults_, shapes_};
}

base::TickRecord Simulation::restart(std::span<const farm::Farm::Restart> restarts,
                                     std::span<const std::uint32_t> resized) {
  SF_CHECK(tick_ > 0, "worlds restart after the first step");
  earlier_readings_.reset();
  settle();
  if (!resized.empty()) {
    fleet_.update_outlines(resized);
    earlier_readings_ = farm_.update_outlines();
  }
  std::vector<base::Report> reports;
  const auto movers = static_cast<std::uint32_t>(world_.movers.size()) / world_.copies;
  for (const farm::Farm::Restart& restart : restarts)
    for (std::uint32_t m = restart.copy * movers; m < (restart.copy + 1) * movers; ++m) {
      fleet_.restart(m);
      if (absent_[m] != world_.movers[m].absent) set_absent(m, world_.movers[m].absent);
      reports.push_back(fleet_.reports()[m]);
      commands_[m] = executed_commands_[m] = {};
      intents_[m] = next_intents_[m] = {};
      estimates_[m] = next_estimates_[m] = {};
      if (!maps_.empty()) maps_[m] = next_maps_[m] = {};
    }
  readings_.clear();
  const auto readings = farm_.restart(restarts, reports);
  const std::int64_t time = static_cast<std::int64_t>(tick_ - 1) * interval_;
  sort_by_mover(readings);
  if (v2v_range_ > 0.0) neighbours_.build(fleet_.reports(), v2v_range_, farm_.episodes().copies());
  for (const base::Report& report : reports) {
    controls_[report.mover] = make_control(report.mover, actor_of(report.mover));
    try_to_decide(report.mover, time, 0);
  }
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return {tick_ - 1, time, recorded_reports(), executed_commands_, fleet_.contacts(), readings, {}, light_states_,
          {},        {}};
}

std::span<const base::Report> Simulation::recorded_reports() {
  if (std::find(absent_.begin(), absent_.end(), true) == absent_.end()) return fleet_.reports();
  present_.assign(fleet_.reports().begin(), fleet_.reports().end());
  for (base::Report& report : present_)
    if (absent_[report.mover]) report.X_WM = base::kAbsent;
  return present_;
}

void Simulation::set_absent(std::uint32_t mover, bool gone) {
  SF_CHECK(mover < absent_.size(), "mover " + std::to_string(mover));
  absent_[mover] = gone;
  commands_[mover] = {};
  intents_[mover] = next_intents_[mover] = {};
  estimates_[mover] = next_estimates_[mover] = {};
  if (!maps_.empty()) maps_[mover] = next_maps_[mover] = {};
  fleet_.set_absent(mover, gone);
  farm_.set_absent(mover, gone);
  if (!gone) farm_.subscribe(mover, farm::kAllSensorTypes);
}

void Simulation::set_shape(world::World& world, std::uint32_t mover, const world::ShapeChange& change) {
  SF_CHECK(&world == &whole_ && mover < absent_.size(), "mover " + std::to_string(mover));
  if (share_->passed_on())
    throw base::InputError(
        "objects cannot change their shapes with --tiles; expected ranks that share the whole world");
  if (shape_changes_ >= kMostShapeChanges)
    throw base::InputError(
        fmt::format("more than {} changes of shapes in one tick; expected fewer", kMostShapeChanges));
  const std::uint32_t color = world::shape_state(world, mover).color;
  const bool outline = world::change_shape(world, mover, change);
  ++shape_changes_;
  if (!outline && world::shape_state(world, mover).color == color) return;
  if (std::ranges::find(reshaped_, mover) == reshaped_.end()) reshaped_.push_back(mover);
  if (!outline) return;
  outlines_changed_ = true;
  fleet_.update_outline(mover);
}

void Simulation::take_shapes() {
  shapes_.clear();
  for (const std::uint32_t mover : std::exchange(reshaped_, {})) shapes_.push_back(world::shape_state(world_, mover));
  shape_changes_ = 0;
  if (std::exchange(outlines_changed_, false)) earlier_readings_ = farm_.update_outlines();
}

void Simulation::set_lane(const std::string& lane, const std::string& use) {
  if (share_->passed_on())
    throw base::InputError("the use of a lane cannot change with --tiles; expected ranks that share the whole world");
  if (world_.copies > 1)
    throw base::InputError("the use of a lane cannot change in several worlds; expected one world");
  if (!roads_) throw base::InputError(world_.file, 0, "has no road network; expected road( rndf \"...\" ) in it");
  const std::uint32_t row = lane_named(*roads_, lane);
  const world::LaneUse wanted = world::lane_use_of(use);
  world::LaneControl& lanes = lanes_ ? *lanes_ : lanes_.emplace(*roads_);
  lanes.request(row, wanted);
}

void Simulation::check_joining(const world::World& world, const JoiningRobot& robot) const {
  SF_CHECK(&world == &whole_, "another world");
  if (world.copies > 1) throw base::InputError("robots cannot join several worlds; expected one world");
  share_->check_may_join();
  const base::Pose& X = robot.X_WM;
  if (!(std::abs(X.x) <= netio::kMaxPosition && std::abs(X.y) <= netio::kMaxPosition && std::isfinite(X.yaw)))
    throw base::InputError(
        fmt::format("'{}' cannot join at ({}, {}, {}); expected finite numbers, x and y within {:g} m", robot.name, X.x,
                    X.y, X.yaw, netio::kMaxPosition));
}

std::uint32_t Simulation::add_robot(world::World& world, const JoiningRobot& robot) {
  check_joining(world, robot);
  settle();
  const std::uint32_t original = world::robot_like(world, robot.like);
  for (std::uint32_t row = 0; row < absent_.size(); ++row)
    if (absent_[row] && world.movers[row].name == robot.name && world::is_same_kind(world, row, original))
      return bring_back(row, robot);
  world::check_name(world, robot.name);
  const std::size_t models = world.models.size();
  const std::uint32_t row = world::append_robot(world, original, robot.name, robot.X_WM);
  share_->add_mover();
  robots::DynamicsPointer dynamics;
  try {
    dynamics = control::make_own_dynamics(world, row);
    RobotControl control = make_control(row, robot.actor);
    earlier_readings_ = farm_.add_mover();
    use_control(std::move(control));
  } catch (...) {
    world.movers.pop_back();
    world.models.resize(models);
    world::update_extent_and_hash(world);
    share_->remove_last();
    throw;
  }
  fleet_.add_mover();
  if (dynamics) fleet_.set_dynamics(row, std::move(dynamics));
  if (states_) states_->add_mover(fleet_.reports()[row]);
  for (auto* const twists : {&commands_, &executed_commands_}) twists->emplace_back();
  for (auto* const intents : {&intents_, &next_intents_}) intents->emplace_back();
  for (auto* const estimates : {&estimates_, &next_estimates_}) estimates->emplace_back();
  first_.push_back(0);
  absent_.push_back(false);
  if (!share_->owns(row)) farm_.sharing().leave_to_others(row);
  farm_.subscribe(row, farm::kAllSensorTypes);
  if (positioning_) camera_inputs_.add(farm_, world_, *positioning_);
  v2v_inputs_.add(farm_);
  make_room();
  joined_.push_back({original, robot.name, world.movers[row].X_WM});
  return row;
}

std::uint32_t Simulation::bring_back(std::uint32_t mover, const JoiningRobot& robot) {
  controls_[mover] = make_control(mover, robot.actor);
  if (const auto& controller = controls_[mover].controller) v2v_range_ = std::max(v2v_range_, controller->v2v_range());
  make_room();
  set_absent(mover, false);
  put(mover, {robot.X_WM.x, robot.X_WM.y, NAN, robot.X_WM.yaw});
  return mover;
}

void Simulation::remove_robot(std::uint32_t mover) {
  share_->check_may_join();
  if (mover >= absent_.size() || absent_[mover])
    throw base::InputError(fmt::format("row {} has no robot to remove", mover));
  settle();
  set_absent(mover, true);
  controls_[mover] = {};
  models_.remove(mover);
  share_->set_status(mover, {});
}

std::span<const base::ReadingBlock> Simulation::sense(std::int64_t time) {
  std::size_t early = 0;
  readings_.clear();
  faults_.clear();
  const auto mark_faults = [this] {
    const auto marks = farm_.fault_marks();
    faults_.insert(faults_.end(), marks.begin(), marks.end());
  };
  const auto states = states_ ? states_->pass(time, fleet_.reports()) : fleet_.reports();
  for (std::int64_t due = farm_.next_due(); due < time; due = farm_.next_due()) {
    const auto delivered = farm_.sample_between(due, states);
    mark_faults();
    if (early_.size() < early + delivered.size()) early_.resize(early + delivered.size());
    for (const base::ReadingBlock& reading : delivered) early_[early++].take(reading);
  }
  farm_.set_commands(executed_commands_);
  receive_inputs(time);
  const auto delivered = farm_.tick(time, states);
  mark_faults();
  if (early == 0) return delivered;
  for (std::size_t i = 0; i < early; ++i) readings_.push_back(early_[i].block());
  readings_.insert(readings_.end(), delivered.begin(), delivered.end());
  return readings_;
}

/// Passes what robots received to derived sensors.
void Simulation::receive_inputs(std::int64_t time) {
  if (camera_inputs_.empty() && v2v_inputs_.empty()) return;
  const auto poses = camera_inputs_.receive(time, fleet_.reports(), absent_);
  received_.assign(poses.begin(), poses.end());
  const auto newest = [&](std::uint32_t mover, std::uint32_t receiver) -> std::optional<farm::V2vInputs::Received> {
    if (!v2v_) {
      const Broadcast now = broadcast_of(fleet_.reports()[mover], time);
      return farm::V2vInputs::Received{time, time, now.state, now.quality};
    }
    const auto arrived = v2v_->newest(time, mover, {world_.movers[receiver].id, world_.movers[mover].id});
    if (!arrived) return std::nullopt;
    return farm::V2vInputs::Received{arrived->sent, arrived->sent, arrived->broadcast.state,
                                     arrived->broadcast.quality};
  };
  const auto others = v2v_inputs_.receive(world_, netio::kV2vRange, newest, fleet_.reports(), absent_);
  received_.insert(received_.end(), others.begin(), others.end());
  farm_.set_received(received_);
}

/// Calls the controllers of models with the states of the last tick.
void Simulation::call_models() {
  const auto start = std::chrono::steady_clock::now();
  const std::int64_t time = static_cast<std::int64_t>(tick_ - 1) * interval_;
  for (const auto& change : models_.call({time, fleet_.reports(), absent_, fleet_, shapes_world_ != nullptr})) {
    const std::uint32_t mover = change.mover;
    if (change.shape.any()) set_shape(*shapes_world_, mover, change.shape);
    if (change.present && *change.present == absent_[mover]) set_absent(mover, !*change.present);
    if (change.X_WM) put(mover, *change.X_WM);
    if (change.velocity) commands_[mover] = *change.velocity;
  }
  move_s_ += base::seconds_since(start);
}

void Simulation::move() {
  const auto start = std::chrono::steady_clock::now();
  fleet_.move(commands_, interval_);
  executed_commands_ = commands_;
  share_->after_motion(v2v_range_ > 0.0);
  move_s_ += base::seconds_since(start);
}

void Simulation::command(std::span<const base::Twist> commands) {
  SF_CHECK(commands.size() == commands_.size(), "commands: expected one per mover");
  for (std::size_t m = 0; m < commands.size(); ++m)
    if (!controls_[m].controller) commands_[m] = commands[m];
}

void Simulation::drive(std::uint32_t mover, const base::Twist& command) {
  SF_CHECK(mover < controls_.size(), "mover " + std::to_string(mover));
  controls_[mover].driven = true;
  models_.remove(mover);
  estimates_[mover] = next_estimates_[mover] = {};
  if (!maps_.empty()) maps_[mover] = next_maps_[mover] = {};
  commands_[mover] = command;
}

void Simulation::put(std::uint32_t mover, const base::Pose& X_WM, const base::Tilt& tilt) {
  SF_CHECK(mover < controls_.size(), "mover " + std::to_string(mover));
  base::Report report{mover, fleet_.reports()[mover].time, X_WM, {}, tilt};
  if (std::isnan(X_WM.z))
    report.X_WM = world::Ground(world_.ramps, world_.terrain).stand(world_.movers[mover].X_WM, X_WM);
  fleet_.apply({&report, 1});
}

void Simulation::sort_by_mover(std::span<const base::ReadingBlock> readings) {
  by_mover_ = readings;
  if (readings_.empty() && index_by_mover(readings)) return;
  std::fill(first_.begin(), first_.end(), 0u);
  for (const base::ReadingBlock& r : readings) ++first_[r.mover + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sorted_.resize(readings.size());
  next_.assign(first_.begin(), first_.end());
  for (const base::ReadingBlock& r : readings) sorted_[next_[r.mover]++] = r;
  by_mover_ = sorted_;
}

/// Sets `first_` for readings in order of movers.
/// @return false if they are in any other order
bool Simulation::index_by_mover(std::span<const base::ReadingBlock> readings) {
  std::atomic<bool> in_order{true};
  farm_.thread_pool().parallel_for(readings.size(), 256, [&](std::size_t begin, std::size_t end, unsigned) {
    std::uint32_t above = begin == 0 ? 0 : readings[begin - 1].mover + 1;  // mover of the previous reading, plus one
    for (std::size_t i = begin; i < end; ++i) {
      if (readings[i].mover + 1 < above) in_order = false;
      for (; above <= readings[i].mover; ++above) first_[above] = static_cast<std::uint32_t>(i);
    }
  });
  const std::size_t rest = readings.empty() ? 0 : readings.back().mover + 1;
  if (in_order) std::fill(first_.begin() + static_cast<std::ptrdiff_t>(rest), first_.end(), readings.size());
  return in_order;
}

std::span<const world::Signal> Simulation::signals_at(std::int64_t time, std::vector<world::Signal>& signals) const {
  signals.clear();
  for (const world::Light& light : world_.lights)
    signals.push_back(world::signal_at(light, 1e-9 * static_cast<double>(time)));
  return signals;
}

void Simulation::decide(std::int64_t time) {
  signals_at(time, signals_);
  std::ranges::transform(signals_, light_states_.begin(), world::status_of);
  if (lanes_) lanes_->update(time, recorded_reports());
  if (v2v_range_ > 0.0) neighbours_.build(fleet_.reports(), v2v_range_, farm_.episodes().copies());
  if (v2v_) {
    broadcasts_.clear();
    for (const base::Report& report : fleet_.reports()) broadcasts_.push_back(broadcast_of(report, time));
    v2v_->send(time, broadcasts_, absent_);
  }
  farm_.thread_pool().parallel_for_each(controls_.size(), 16, [&](std::size_t m, unsigned thread) {
    try_to_decide(static_cast<std::uint32_t>(m), time, thread);
  });
}

void Simulation::settle() {
  share_->finish_step({commands_, next_intents_, next_estimates_});
  std::copy(next_intents_.begin(), next_intents_.end(), intents_.begin());
  std::copy(next_estimates_.begin(), next_estimates_.end(), estimates_.begin());
  std::copy(next_maps_.begin(), next_maps_.end(), maps_.begin());
}

ControlStatus Simulation::own_status(std::uint32_t mover) const {
  const RobotControl& robot = controls_[mover];
  if (!robot.controller) return {};
  return {true, robot.stepped, robot.controller->done(), robot.controller->error()};
}

ControlStatus Simulation::status(std::uint32_t mover) const {
  const ControlStatus* agreed = share_->status(mover);
  return agreed != nullptr ? *agreed : own_status(mover);
}

/// Calls `decide_one`, and stores the error of the first mover that fails, because exceptions must not leave a thread
/// of the pool.
void Simulation::try_to_decide(std::uint32_t mover, std::int64_t time, unsigned thread) {
  try {
    decide_one(mover, time, thread);
  } catch (...) {
    const std::scoped_lock guard(failure_lock_);
    if (mover >= failed_) return;
    failed_ = mover;
    failure_ = std::current_exception();
  }
}

void Simulation::decide_one(std::uint32_t mover, std::int64_t farm_time, unsigned thread) {
  const std::int64_t start = farm_.episodes().start_of(mover), time = farm_time - start;
  RobotControl& robot = controls_[mover];
  robot.stepped = false;
  if (!robot.controller || robot.driven || absent_[mover]) return;
  const std::uint32_t first = first_[mover], count = first_[mover + 1] - first;
  std::span<const base::ReadingBlock> fresh = by_mover_.subspan(first, count);
  if (robot.mailbox) {
    for (const base::ReadingBlock& reading : fresh)
      robot.mailbox->send(reading, std::min(time, leaves_at(reading) - start));
  } else if (!readings_.empty()) {
    fresh = newest_of(std::span(sorted_).subspan(first, count));
  }
  if (robot.positioning) robot.positioning->measure(time, fleet_.reports()[mover].X_WM);
  const bool contact = fleet_.contacts()[mover] != 0;
  if (!due(robot, fresh, time, contact)) return;

  std::vector<control::Neighbour>& others = others_[thread];
  others.clear();
  find_others(mover, time, others);
  if (robot.sharing != nullptr) exchange_maps(*robot.sharing, others);
  const auto readings = robot.mailbox ? robot.mailbox->receive(time) : fresh;
  const auto poses = robot.positioning ? robot.positioning->receive(time) : std::span<const control::MeasuredPose>();
  base::Report state = fleet_.reports()[mover];
  state.time -= start;
  commands_[mover] = robot.controller->step({time, state, readings, contact, time >= start_at_, others,
                                             start == 0 ? signals_ : signals_at(time, own_signals_[thread]),
                                             lanes_ ? lanes_->network() : nullptr, poses});
  next_intents_[mover] = robot.controller->intent();
  if (const control::OwnLocalization* own = control::localization_of(*robot.controller))
    next_estimates_[mover] = {own->state(), own->quality()};
  if (robot.sharing != nullptr) next_maps_[mover] = robot.sharing->shared_map();
  robot.stepped = true;
}

/// [ns] Returns the delivery time of a reading, possibly between two ticks.
std::int64_t Simulation::leaves_at(const base::ReadingBlock& reading) const { return farm_.delivery_time(reading); }

/// Returns whether the controller steps at this tick. Otherwise its last command remains in effect.
bool Simulation::due(RobotControl& robot, std::span<const base::ReadingBlock> fresh, std::int64_t time,
                     bool contact) const {
  if (robot.on_scans) {
    if (robot.mailbox) robot.mailbox->receive(time);
    const bool looked = robot.mailbox ? robot.mailbox->renewed(sensors::kLaser)
                                      : std::any_of(fresh.begin(), fresh.end(), [](const base::ReadingBlock& r) {
                                          return r.type == sensors::kLaser;
                                        });
    return looked || contact;
  }
  const std::uint64_t begun = farm::readings_started(time, robot.rate, 0.0);
  if (begun <= robot.begun) return false;
  robot.begun = begun;
  return true;
}

/// Passes the maps that the others have sent by the last tick. Those of a [v2v] link are not delayed.
void Simulation::exchange_maps(control::SharesMap& controller, std::span<const control::Neighbour> others) const {
  std::vector<control::TeammateMap> maps;
  for (const control::Neighbour& other : others)
    if (const auto& map = maps_[other.state.mover]) maps.push_back({other.id, map});
  controller.receive_maps(maps);
}

/// Returns what a robot broadcasts at `time` [ns]: the estimate of its last step, extrapolated, if it has one.
Broadcast Simulation::broadcast_of(const base::Report& truth, std::int64_t time) const {
  const auto& [estimate, quality] = estimates_[truth.mover];
  Broadcast broadcast{truth, intents_[truth.mover], quality};
  if (!quality.stated) return broadcast;
  const base::Report state = robots::extrapolate(estimate, time);
  broadcast.state.X_WM = state.X_WM;
  broadcast.state.velocity = state.velocity;
  return broadcast;
}

void Simulation::find_others(std::uint32_t mover, std::int64_t time, std::vector<control::Neighbour>& others) const {
  const double v2v_range = controls_[mover].controller->v2v_range();
  if (v2v_range <= 0.0) return;
  const std::span<const base::Report> reports = fleet_.reports();
  const world::CopyIndex& copies = farm_.episodes().copies();
  const auto add = [&](const base::Report& other) {
    const std::uint32_t id = world_.movers[other.mover].id;
    if (other.mover == mover || world_.movers[other.mover].is_tag || absent_[other.mover]) return;
    const auto received = v2v_ ? v2v_->receive(time, other.mover, {world_.movers[mover].id, id})
                               : std::optional(broadcast_of(other, time));
    if (received && received->quality.age != base::kNoStateYet)  // a lost robot broadcasts nothing
      others.push_back({id, received->state, received->intent, received->quality}),
          others.back().state.time -= farm_.episodes().start_of(mover);
  };
  const glm::dvec2 here{reports[mover].X_WM.x, reports[mover].X_WM.y};
  if (const auto remote = share_->remote_neighbours(mover))
    for (const base::Report& other : *remote) add(other);
  else {
    const auto visit = [&](std::uint32_t row) {
      const base::Pose& X_WM = reports[row].X_WM;
      if (share_->knows(row) && glm::length(glm::dvec2{X_WM.x, X_WM.y} - here) <= v2v_range) add(reports[row]);
      return false;
    };
    neighbours_.any(here, v2v_range, visit, copies.copy_of(mover));
  }
  std::sort(others.begin(), others.end(),
            [](const control::Neighbour& p, const control::Neighbour& q) { return p.id < q.id; });
}

}  // namespace sf::scenarios
