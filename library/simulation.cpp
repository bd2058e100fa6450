#include "sensorfarm/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <numeric>
#include <optional>
#include <tuple>

#include "base/bytes.h"
#include "base/error.h"
#include "base/suggest.h"
#include "base/tilted_pose.h"
#include "cluster/failure.h"
#include "cluster/shares.h"
#include "control/own_controller.h"
#include "control/own_controllers.h"
#include "library/errors.h"
#include "library/loading.h"
#include "library/observations.h"
#include "library/ranks.h"
#include "library/reading_table.h"
#include "library/recorded_world.h"
#include "raycast/casters.h"
#include "record/recorder.h"
#include "scenarios/fault_tables.h"
#include "scenarios/run_info.h"
#include "scenarios/scenario.h"
#include "scenarios/simulation.h"
#include "sensors/derived/own_derived.h"
#include "sensors/own_sensors.h"
#include "viz/top_view.h"
#include "viz/world_figure.h"

namespace sensorfarm {

using namespace sf;

namespace {

scenarios::SimulationOptions simulation_options(const world::World& world, const Options& options,
                                                cluster::Ranks* ranks) {
  scenarios::SimulationOptions simulation{.seed = options.seed, .threads = cluster::threads_of(options.threads, ranks)};
  simulation.ranks = ranks;
  simulation.noise = options.noise;
  simulation.caster = raycast::caster_named(options.caster);
  if (!options.positioning.empty()) {
    simulation.positioning = scenarios::parse_positioning("positioning", options.positioning);
    simulation.positioning->link.seed = options.seed;
  }
  if (!options.faults.empty()) simulation.faults = scenarios::parse_faults("faults", options.faults);
  const bool none = options.controller == "none";
  simulation.actor.controller = library::controller_of(none ? "" : options.controller, options.settings);
  if (options.controller.empty())
    for (std::size_t row = 0; row < world.movers.size() / world.copies; ++row)
      simulation.actors.push_back({control::controller_of(world.movers[row], simulation.actor.controller), {}});
  return simulation;
}

}  // namespace

/// Memory of views created before a robot joined or an outline changed. The views keep it alive.
struct Earlier {
  std::vector<Pose> poses;
  std::vector<Twist> velocities;
  std::vector<std::uint8_t> contacts, done, owned, present;
  std::vector<library::ReadingTable> tables;
  std::shared_ptr<const void> readings;
};

/// Appends a row. The old memory stays in `before`.
template <class Row>
void add_row(std::vector<Row>& rows, const Row& row, std::vector<Row>& before) {
  before = rows;
  before.push_back(row);
  rows.swap(before);
}

/// World, simulation and tables of readings, at one address.
struct Simulation::State {
  State(library::WorldSource source, const Options& given);
  void prepare();
  void record();
  void step(std::span<const Twist> commands);
  void set(std::span<const Twist> given);
  void exchange(std::span<const Twist> given);
  void restart(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds, const WorldStarts& starts);
  /// [ns] Returns the farm's time at which a world started.
  std::int64_t start_of(std::size_t k) const {
    if (k >= world.copies) throw Error(fmt::format("there is no world {}; expected less than {}", k, world.copies));
    return simulation->farm().episodes().start_of(static_cast<std::uint32_t>(k * robots.size()));
  }
  const std::string& name_of(std::size_t row) const { return robots[row % robots.size()].name; }
  void put(std::size_t row, const Pose& pose, const base::Tilt& tilt = {});
  void put7(std::size_t row, const Pose7& pose);
  std::span<const Pose7> poses_with_tilts();
  std::size_t add(const NewRobot& robot);
  void add_tables(std::vector<library::ReadingTable>& before);
  void remove(std::size_t row);
  void set_shape(std::size_t row, const ShapeChange& given);
  record::RunInfo run_info() const;
  void take(const base::TickRecord& tick, std::span<const std::uint32_t> restarted = {});
  library::ObservedStep observed(const Observations::State& by) const {
    return {table(by.options.sensor).view(), poses, velocities};
  }
  void observe(std::span<const std::uint32_t> restarted);
  const library::ReadingTable& table(std::string_view type) const;
  const viz::TopView& top_view(const ImageOptions& wanted);
  std::vector<base::Pose> poses_of(std::size_t k) const;
  world::World now(std::size_t k) const;

  library::WorldSource source;
  Options options;
  cluster::Ranks* ranks;  ///< null: a single process
  std::shared_ptr<gpu::Device> device;
  library::LoadedWorld loaded;
  world::World& world = loaded.world;
  std::optional<scenarios::Simulation> simulation;
  std::vector<library::ReadingTable> tables;
  std::optional<library::RecordedWorld> recorded;  ///< of several; nullopt: there is one
  std::optional<record::Recorder> recorder;
  std::vector<Robot> robots;
  std::vector<std::string> models;
  std::vector<std::string> warnings;
  std::vector<base::Twist> commands;
  std::vector<base::Twist> sent;  ///< the commands as last sent to the other ranks
  bool commanded = false;         ///< at least one row has no controller
  std::vector<Pose> poses;
  std::vector<Twist> velocities;
  std::vector<std::uint8_t> contacts, done, owned, present;
  std::vector<double> radii;
  std::shared_ptr<Earlier> earlier = std::make_shared<Earlier>();  ///< for the next robot that joins
  std::vector<base::ReadingBlock> of_type;                         ///< scratch
  std::vector<Pose7> poses7;                                       ///< as of the last `poses_with_tilts`
  std::vector<std::pair<ImageOptions, viz::TopView>> top_views;    ///< of the last images, the newest at the end
  std::vector<std::weak_ptr<Observations::State>> observers;
  std::uint64_t tick = 0;
  std::int64_t time = 0;  ///< [ns] of the farm
};

Simulation::State::State(library::WorldSource from, const Options& given)
    : source(std::move(from)), options(given), ranks(given.ranks ? library::joined_ranks() : nullptr) {
  cluster::agree(ranks, [&] { prepare(); });
  take(simulation->step());
}

void Simulation::State::prepare() {
  device = library::shared_device(options);
  if (options.copies > 1 && ranks != nullptr)
    throw base::InputError(fmt::format("{} copies of a world cannot be shared by ranks; expected one", options.copies));
  loaded = library::load(source, options);
  const scenarios::SimulationOptions given = simulation_options(world, options, ranks);
  simulation.emplace(world, *device, given);
  farm::check_faults(given.faults, world, simulation->farm().sensor_set());
  simulation->change_shapes_in(world);
  const sensors::SensorSet& sensor_set = simulation->farm().sensor_set();
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) tables.emplace_back(group, world.interval);
  for (std::uint32_t row = 0; row < world.movers.size() / world.copies; ++row)
    robots.push_back(control::robot_of({world, row, options.seed, nullptr, nullptr, &sensor_set}));
  for (const world::Model& model : world.models) models.push_back(model.name);
  if (!device->notice().empty()) warnings.push_back(device->notice());
  for (const world::Warning& w : world.warnings)
    warnings.push_back(fmt::format("{}:{}: {}", w.file, w.line, w.message));
  for (std::string& warning : warnings) warning = library::in_own_words(std::move(warning));
  commands.assign(world.movers.size(), {});
  sent = commands;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    owned.push_back(simulation->share().owns(row));
    commanded = commanded || !simulation->status(row).drives;
  }
  poses.resize(world.movers.size()), velocities.resize(poses.size());
  contacts.resize(poses.size()), done.resize(poses.size());
  present.assign(poses.size(), 1);
  for (const world::Mover& mover : world.movers) radii.push_back(mover.radius);
  if (!options.record.empty()) record();
}

/// Readings of other ranks are recorded in their own parts; without readings the first rank records everything.
void Simulation::State::record() {
  if (options.compression != "zstd" && options.compression != "none")
    throw base::InputError(fmt::format("compression: expected \"zstd\" or \"none\", got \"{}\"", options.compression));
  record::RecordingPart part;
  if (ranks != nullptr && options.record_readings) part = {ranks->rank(), ranks->size()};
  if (options.compression == "none") part.compression = record::Compression::none;
  if (ranks != nullptr && !options.record_readings && ranks->rank() > 0) return;
  if (world.copies > 1 || options.record_world > 0) recorded.emplace(world, options.record_world);
  recorder.emplace(options.record, run_info(), part);
  for (const std::string& note : recorder->taken_names()) warnings.push_back("topics: " + note);
}

record::RunInfo Simulation::State::run_info() const {
  return scenarios::run_info(
      recorded ? recorded->world() : world, recorded ? recorded->sensor_set() : simulation->farm().sensor_set(),
      {.seed = options.seed + options.record_world,
       .record_readings = options.record_readings,
       .caster = raycast::describe_caster(device->info().software, raycast::caster_named(options.caster)),
       .noise = options.noise,
       .joined = simulation->joined(),
       .too_near_min = options.too_near_min,
       .faults = options.faults});
}

void Simulation::State::step(std::span<const Twist> given) {
  if (ranks == nullptr)
    set(given);
  else if (commanded)
    exchange(given);
  simulation->command(commands);
  take(simulation->step());
  observe({});
  if (auto readings = simulation->earlier_readings()) {
    earlier->readings = std::move(readings);
    earlier = std::make_shared<Earlier>();
  }
}

/// Sets the commands of this rank's rows.
void Simulation::State::set(std::span<const Twist> given) {
  if (!given.empty() && given.size() != commands.size())
    throw base::InputError(
        fmt::format("{} commands for {} robots; expected one per row", given.size(), commands.size()));
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (owned[i] == 0) continue;
    const Twist& twist = given[i];
    if (!std::isfinite(twist.forward) || !std::isfinite(twist.left) || !std::isfinite(twist.turn))
      throw base::InputError(fmt::format("the command of '{}' is ({}, {}, {}); expected finite numbers", name_of(i),
                                         twist.forward, twist.left, twist.turn));
    commands[i] = {twist.forward, twist.left, twist.turn};
  }
}

/// Calls `set` on all ranks: each sends the new commands of its rows, or the reason why it refuses them.
void Simulation::State::exchange(std::span<const Twist> given) {
  std::string refusal;
  try {
    set(given);
  } catch (const base::InputError& error) {
    refusal = error.what();
  }
  base::Bytes block;
  base::ByteWriter out(block);
  out.put_string(refusal);
  for (std::uint32_t i = 0; i < commands.size(); ++i) {
    if (owned[i] == 0 || std::memcmp(&commands[i], &sent[i], sizeof sent[i]) == 0) continue;
    out.put(i);
    for (const double value : {commands[i].forward, commands[i].left, commands[i].turn}) out.put(value);
    sent[i] = commands[i];
  }
  for (const cluster::Block other : ranks->exchange(block)) {
    base::ByteReader in(other);
    if (const std::string why = in.get_string(); !why.empty()) throw cluster::Failure(2, why);
    while (in.left() > 0) {
      base::Twist& command = commands.at(in.get<std::uint32_t>());
      for (double* value : {&command.forward, &command.left, &command.turn}) *value = in.get<double>();
    }
  }
}

void Simulation::State::restart(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds,
                                const WorldStarts& starts) {
  library::check_restart(world, worlds, seeds);
  loaded.starts.check(world, starts, worlds.size() * robots.size());
  std::vector<farm::Farm::Restart> restarts;
  std::vector<std::uint32_t> resized;
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    const std::size_t first = worlds[i] * robots.size();
    restarts.push_back({worlds[i], seeds[i]});
    loaded.starts.place(world, worlds[i], seeds[i], starts, i * robots.size(), resized);
    std::fill_n(commands.begin() + static_cast<std::ptrdiff_t>(first), robots.size(), base::Twist{});
  }
  for (const std::uint32_t row : resized) radii[row] = world.movers[row].radius;
  for (library::ReadingTable& table : tables) table.hold();
  if (worlds.empty()) return;
  const auto movers = static_cast<std::uint32_t>(robots.size());
  for (library::ReadingTable& table : tables)
    for (const std::uint32_t k : worlds) table.forget(k * movers, (k + 1) * movers);
  if (recorder && std::ranges::find(worlds, options.record_world) != worlds.end()) {
    recorder->finish();
    recorder.reset();
  }
  take(simulation->restart(restarts, resized), worlds);
  observe(worlds);
}

void Simulation::State::put(std::size_t row, const Pose& pose, const base::Tilt& tilt) {
  if (row >= poses.size())
    throw base::InputError(fmt::format("there is no row {}; expected less than {}", row, poses.size()));
  if (!present[row])
    throw base::InputError(fmt::format("'{}' was removed; add it again before placing it", name_of(row)));
  if (!library::is_placeable(pose))
    throw base::InputError(fmt::format("the pose of '{}' is not finite, or beyond 1e7: ({:g}, {:g}, {:g}, {:g})",
                                       name_of(row), pose.x, pose.y, pose.z, pose.yaw));
  simulation->put(static_cast<std::uint32_t>(row), {pose.x, pose.y, pose.z, pose.yaw}, tilt);
  poses[row] = pose, velocities[row] = {};
}

void Simulation::State::put7(std::size_t row, const Pose7& pose) {
  const double norm = base::hypot(base::hypot(pose.w, pose.qx), base::hypot(pose.qy, pose.qz));
  if (!(std::abs(norm - 1.0) <= 1e-3))
    throw base::InputError(
        fmt::format("the quaternion of row {} has the norm {:.4g}; expected a unit quaternion w, x, y, z", row, norm));
  const auto [X, tilt] = base::tilted_pose_of(
      {base::rotation_of(base::Quaternion{pose.w, pose.qx, pose.qy, pose.qz}), {pose.x, pose.y, pose.z}});
  put(row, {X.x, X.y, X.z, X.yaw}, tilt);
}

/// Fills the rows of absent robots with NaN.
std::span<const Pose7> Simulation::State::poses_with_tilts() {
  poses7.clear();
  for (std::uint32_t row = 0; row < poses.size(); ++row) {
    const Pose& p = poses[row];
    const base::Tilt tilt = present[row] != 0 ? simulation->tilt(row) : base::Tilt{NAN, NAN};
    const base::Quaternion q = base::quaternion_of(p.yaw, tilt);
    poses7.push_back({p.x, p.y, p.z, q.w, q.x, q.y, q.z});
  }
  return poses7;
}

std::size_t Simulation::State::add(const NewRobot& robot) {
  if (ranks != nullptr && !options.record.empty() && options.record_readings)
    throw base::InputError(
        fmt::format("'{}' cannot join while several ranks record readings; expected a recording "
                    "without readings, or one process",
                    robot.name));
  scenarios::JoiningRobot joining{
      .name = robot.name, .like = robot.like, .X_WM = {robot.pose.x, robot.pose.y, robot.pose.z, robot.pose.yaw}};
  joining.actor.controller = library::controller_of(robot.controller, robot.settings);
  const std::uint32_t row = simulation->add_robot(world, joining);
  commanded = commanded || !simulation->status(row).drives;
  const base::Pose& X = world.movers[row].X_WM;
  const Pose pose{robot.pose.x, robot.pose.y, X.z, robot.pose.yaw};
  if (row < poses.size()) {
    present[row] = 1, poses[row] = pose;
    return row;
  }
  robots.push_back(control::robot_of({world, row, options.seed, nullptr, nullptr, &simulation->farm().sensor_set()}));
  models.clear();
  for (const world::Model& model : world.models) models.push_back(model.name);
  top_views.clear();
  for (auto* const twists : {&commands, &sent}) twists->emplace_back();
  add_row(poses, pose, earlier->poses), add_row(velocities, {}, earlier->velocities);
  for (const auto& [rows, before] : {std::pair{&contacts, &earlier->contacts}, {&done, &earlier->done}})
    add_row(*rows, std::uint8_t{0}, *before);
  add_row(present, std::uint8_t{1}, earlier->present);
  radii.push_back(world.movers[row].radius);
  add_row(owned, static_cast<std::uint8_t>(simulation->share().owns(row)), earlier->owned);
  add_tables(earlier->tables);
  earlier->readings = simulation->earlier_readings();
  earlier = std::make_shared<Earlier>();
  if (recorder) recorder->add_movers(run_info());
  return row;
}

void Simulation::State::add_tables(std::vector<library::ReadingTable>& before) {
  before.swap(tables);
  for (const sensors::SensorSet::Group& group : simulation->farm().sensor_set().groups()) {
    library::ReadingTable& table = tables.emplace_back(group, world.interval);
    for (const library::ReadingTable& old : before)
      if (old.view().type == table.view().type) table.go_on(old);
  }
}

void Simulation::State::remove(std::size_t row) {
  if (row >= poses.size() || present[row] == 0)
    throw base::InputError(fmt::format("row {} has no robot to remove", row));
  simulation->remove_robot(static_cast<std::uint32_t>(row));
  present[row] = 0, contacts[row] = 0, done[row] = 0;
  poses[row] = {NAN, NAN, NAN, NAN}, velocities[row] = {};
}

void Simulation::State::set_shape(std::size_t row, const ShapeChange& given) {
  if (row >= poses.size())
    throw base::InputError(fmt::format("there is no row {}; expected less than {}", row, poses.size()));
  if (world.copies > 1) throw base::InputError("shapes cannot change in several worlds; expected one world");
  world::ShapeChange change;
  if (!given.shape.empty()) change.shape = given.shape;
  if (!given.color.empty()) change.color = world::color_named(given.color);
  if (const auto& size = given.size) change.size = glm::dvec3{(*size)[0], (*size)[1], (*size)[2]};
  simulation->set_shape(world, static_cast<std::uint32_t>(row), change);
  radii[row] = world.movers[row].radius;
}

/// Writes the observations of a step, or of the worlds that restarted.
void Simulation::State::observe(std::span<const std::uint32_t> restarted) {
  std::erase_if(observers, [](const auto& observer) { return observer.expired(); });
  for (const auto& observer : observers) {
    const auto state = observer.lock();
    if (restarted.empty())
      state->step(observed(*state), simulation->thread_pool());
    else
      state->restart(observed(*state), restarted);
  }
}

/// @param restarted the worlds that the record changes; empty: all
void Simulation::State::take(const base::TickRecord& record, std::span<const std::uint32_t> restarted) {
  const auto for_rows = [&](auto&& body) {
    for (std::size_t i = 0; i < poses.size() && restarted.empty(); ++i) body(i);
    for (const std::size_t k : restarted)
      for (std::size_t i = k * robots.size(); i < (k + 1) * robots.size(); ++i) body(i);
  };
  tick = record.tick, time = record.time;
  for_rows([&](std::size_t i) {
    const base::Report& report = record.reports[i];
    poses[i] = {report.X_WM.x, report.X_WM.y, report.X_WM.z, report.X_WM.yaw};
    velocities[i] = {report.velocity.forward, report.velocity.left, report.velocity.turn};
    contacts[i] = record.contacts[i];
    present[i] = base::is_absent(report.X_WM) ? 0 : 1;
  });
  for (library::ReadingTable& table : tables) {
    const auto is_own = [&](const base::ReadingBlock& reading) { return reading.type == table.type(); };
    const bool all = std::ranges::all_of(record.readings, is_own);
    of_type.clear();
    if (!all) std::ranges::copy_if(record.readings, std::back_inserter(of_type), is_own);
    table.take(all ? record.readings : of_type);
  }
  if (recorder && ranks == nullptr && !record.shapes.empty()) recorder->add_movers(run_info());  // with new bodies
  if (recorder && restarted.empty()) recorder->write(recorded ? recorded->part_of(record) : record);
  simulation->settle();
  for_rows([&](std::size_t i) {
    const auto row = static_cast<std::uint32_t>(i);
    const control::Controller* controller = simulation->controller(row);
    done[i] = owned[i] != 0 ? controller != nullptr && controller->done() : simulation->status(row).done;
  });
}

std::vector<base::Pose> Simulation::State::poses_of(std::size_t k) const {
  start_of(k);
  std::vector<base::Pose> X_WM;
  for (const Pose& pose : std::span(poses).subspan(k * robots.size(), robots.size()))
    X_WM.push_back({pose.x, pose.y, pose.z, pose.yaw});
  return X_WM;
}

/// Returns one of the worlds with its movers at their present poses.
world::World Simulation::State::now(std::size_t k) const {
  const std::vector<base::Pose> X_WM = poses_of(k);
  world::World shown = world;
  shown.copies = 1;
  shown.movers.resize(X_WM.size());
  for (std::size_t i = 0; i < X_WM.size(); ++i) shown.movers[i].X_WM = X_WM[i];
  std::erase_if(shown.movers, [](const world::Mover& mover) { return base::is_absent(mover.X_WM); });
  return shown;
}

const library::ReadingTable& Simulation::State::table(std::string_view type) const {
  std::vector<std::string_view> known;
  for (const library::ReadingTable& table : tables) {
    if (table.view().type == type) return table;
    known.push_back(table.view().type);
  }
  throw base::InputError(fmt::format("{} has no sensor of type '{}'{}", world.file, type,
                                     known.empty() ? "; it has no sensors" : base::expected_one_of(type, known)));
}

const viz::TopView& Simulation::State::top_view(const ImageOptions& wanted) {
  constexpr std::size_t kKept = 4;
  const auto same = std::find_if(top_views.begin(), top_views.end(), [&](const auto& known) {
    return std::tie(known.first.width, known.first.height, known.first.view) ==
           std::tie(wanted.width, wanted.height, wanted.view);
  });
  if (same != top_views.end()) {
    std::rotate(same, same + 1, top_views.end());
    return top_views.back().second;
  }
  viz::TopViewOptions shown{.width = wanted.width, .height = wanted.height, .extent = {}};
  if (const auto& v = wanted.view) shown.extent = {(*v)[0], (*v)[1], (*v)[2], (*v)[3]};
  viz::TopView view(world, shown);
  if (top_views.size() == kKept) top_views.erase(top_views.begin());
  return top_views.emplace_back(wanted, std::move(view)).second;
}

Simulation::Simulation(const std::string& world, const Options& options)
    : state_(library::translated([&] {
        return std::make_shared<State>(library::WorldSource{library::found(world), ""}, options);
      })) {}

Simulation::Simulation(std::shared_ptr<State> state) : state_(std::move(state)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

Simulation Simulation::from_text(const std::string& text, const Options& options, const std::string& name) {
  return library::translated([&] {
    return Simulation(std::make_shared<State>(library::WorldSource{name, text}, options));
  });
}

void Simulation::step() { step({}); }
void Simulation::step(std::span<const Twist> commands) {
  library::translated([&] { state_->step(commands); });
}

void Simulation::reset() { reset(state_->options.seed); }
void Simulation::reset(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds,
                       const WorldStarts& starts) {
  library::translated([&] { state_->restart(worlds, seeds, starts); });
}
void Simulation::reset(std::uint64_t seed) {
  if (copies() > 1) {
    std::vector<std::uint32_t> worlds(copies());
    std::iota(worlds.begin(), worlds.end(), 0u);
    std::vector<std::uint64_t> seeds(copies());
    std::iota(seeds.begin(), seeds.end(), seed);
    return reset(worlds, seeds);
  }
  // Views of the old run keep its memory. Its recording ends here, because the new one uses the same folder.
  finish_recording();
  state_->recorder.reset();
  state_ = library::translated([&] {
    Options options = state_->options;
    options.seed = seed;
    auto state = std::make_shared<State>(state_->source, options);
    state->observers = std::move(state_->observers);
    std::vector<std::uint32_t> all(state->world.copies);
    std::iota(all.begin(), all.end(), 0u);
    state->observe(all);
    return state;
  });
}

Observations Simulation::observe(const ObservationOptions& options) {
  return library::translated([&] {
    const std::uint8_t type = state_->table(options.sensor).type();
    const auto groups = state_->simulation->farm().sensor_set().groups();
    const auto group = std::ranges::find_if(groups, [&](const auto& each) { return each.type->id == type; });
    auto made = std::make_shared<Observations::State>(options, state_->world, *group);
    std::vector<std::uint32_t> all(state_->world.copies);
    std::iota(all.begin(), all.end(), 0u);
    made->restart(state_->observed(*made), all);
    state_->observers.push_back(made);
    return Observations(std::move(made));
  });
}

std::size_t Simulation::add_robot(const NewRobot& robot) {
  return library::translated([&] { return state_->add(robot); });
}
void Simulation::remove_robot(std::size_t row) {
  library::translated([&] { state_->remove(row); });
}

void Simulation::set_lane(const std::string& lane, const std::string& use) {
  library::translated([&] { state_->simulation->set_lane(lane, use); });
}

void Simulation::set_shape(std::size_t row, const ShapeChange& change) {
  library::translated([&] { state_->set_shape(row, change); });
}

std::vector<std::string> Simulation::shapes() const {
  std::vector<std::string> names;
  for (const world::Shape& shape : state_->world.shapes) names.push_back(shape.name);
  return names;
}

void Simulation::put(std::size_t row, const Pose& pose) {
  library::translated([&] { state_->put(row, pose); });
}

std::size_t Simulation::copies() const { return state_->world.copies; }
std::size_t Simulation::size() const { return state_->poses.size(); }
const std::vector<Robot>& Simulation::robots() const { return state_->robots; }
void Simulation::put7(std::size_t row, const Pose7& pose) {
  library::translated([&] { state_->put7(row, pose); });
}
std::span<const Pose> Simulation::poses() const { return state_->poses; }
std::span<const Pose7> Simulation::poses7() const { return state_->poses_with_tilts(); }
std::span<const Twist> Simulation::velocities() const { return state_->velocities; }
std::span<const double> Simulation::radii() const { return state_->radii; }
std::span<const std::uint8_t> Simulation::contacts() const { return state_->contacts; }
std::span<const std::uint8_t> Simulation::done() const { return state_->done; }
std::span<const std::uint8_t> Simulation::present() const { return state_->present; }

std::vector<std::string> Simulation::types() const {
  std::vector<std::string> names;
  for (const library::ReadingTable& table : state_->tables) names.emplace_back(table.view().type);
  return names;
}

Readings Simulation::readings(std::string_view type) const {
  return library::translated([&] { return state_->table(type).view(); });
}

const std::vector<std::string>& Simulation::models() const { return state_->models; }
double Simulation::interval() const { return state_->world.interval; }
double Simulation::time(std::size_t world) const {
  return 1e-9 * static_cast<double>(state_->time - state_->start_of(world));
}
std::uint64_t Simulation::tick(std::size_t world) const {
  return state_->tick -
         static_cast<std::uint64_t>(std::llround(1e-9 * static_cast<double>(state_->start_of(world)) / interval()));
}
unsigned Simulation::rank() const { return state_->ranks == nullptr ? 0 : state_->ranks->rank(); }
unsigned Simulation::ranks() const { return state_->ranks == nullptr ? 1 : state_->ranks->size(); }
std::span<const std::uint8_t> Simulation::owned() const { return state_->owned; }

std::uint64_t Simulation::hash(std::size_t world) const {
  if (rank() > 0) throw Error("only rank 0 has the hash of all ranks' readings");
  if (world >= copies()) throw Error(fmt::format("there is no world {}; expected less than {}", world, copies()));
  return state_->simulation->farm().hash(static_cast<std::uint32_t>(world));
}

std::string Simulation::description() const {
  const gpu::DeviceInfo& info = state_->device->info();
  return fmt::format("{}, rays cast by: {}", info.name,
                     raycast::describe_caster(info.software, raycast::caster_named(state_->options.caster)));
}

const std::vector<std::string>& Simulation::warnings() const { return state_->warnings; }

void Simulation::finish_recording() {
  library::translated([&] {
    if (state_->recorder) state_->recorder->finish();
  });
}

void Simulation::draw(const std::string& file, std::size_t world) const {
  library::translated([&] { viz::draw_world(state_->now(world), file); });
}

Image Simulation::image(const ImageOptions& options, std::size_t world) const {
  return library::translated([&] {
    viz::PixelImage image = state_->top_view(options).paint(state_->poses_of(world), time(world));
    return Image{image.width, image.height, std::move(image.rgb)};
  });
}

std::shared_ptr<const void> Simulation::memory() const {
  return std::make_shared<std::pair<std::shared_ptr<State>, std::shared_ptr<Earlier>>>(state_, state_->earlier);
}

void add_controller(ControllerEntry entry) {
  library::translated([&] { control::add_own_controller(std::move(entry), "add_controller"); });
}

void add_model_controller(ModelEntry entry) {
  library::translated([&] { control::add_own_model_controller(std::move(entry), "add_model_controller"); });
}

void add_sensor(SensorEntry entry) {
  library::translated([&] { sensors::add_own_sensor(std::move(entry), "add_sensor"); });
}

void add_derived(DerivedEntry entry) {
  library::translated([&] { sensors::add_own_derived(std::move(entry), "add_derived"); });
}

void load_plugin(const std::string& file) {
  library::translated([&] { control::load_plugin_file(file); });
}

}  // namespace sensorfarm
