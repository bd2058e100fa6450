#include "robots/device/device_fleet.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <set>
#include <utility>

#include "base/elementary.h"
#include "base/error.h"
#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/group_counts.h"
#include "gpu/kernel.h"
#include "robots/device/fleet_tables.h"
#include "robots/fleet.h"
#include "shaders/fleet_advance.comp.h"
#include "shaders/fleet_commit.comp.h"
#include "shaders/fleet_contacts.comp.h"
#include "shaders/fleet_index.comp.h"
#include "shaders/fleet_start.comp.h"
#include "world/copies.h"

namespace sf::robots {

namespace {

using gpu::Buffer;
using gpu::Kernel;
using gpu::Role;

constexpr double kMostSteps = 1'000.0;  // [substeps] robots::Fleet tests longer paths in pieces
constexpr double kMostTurn = 1e5;       // [rad] shaders/lib/elementary64.glsl

static_assert(Fleet::kRounds == SF_FLEET_ROUNDS);
static_assert(SF_FLEET_DONE == 2 * SF_FLEET_ROUNDS + 2);

FleetPose pose_record(const base::Pose& X_WM) {
  const auto [s, c] = base::sin_cos(X_WM.yaw);
  return {X_WM.x, X_WM.y, X_WM.z, X_WM.yaw, s, c};
}

std::vector<FleetPose> load_poses(const world::World& world) {
  std::vector<FleetPose> poses;
  for (const world::Mover& mover : world.movers) poses.push_back(pose_record(mover.X_WM));
  if (poses.empty()) poses.emplace_back();
  return poses;
}

/// Returns the different bounds of all movers.
std::vector<MotionBound> motion_bounds(const world::World& world) {
  std::set<MotionBound> bounds;
  for (const world::Mover& mover : world.movers) bounds.insert(motion_bound(mover));
  return {bounds.begin(), bounds.end()};
}

}  // namespace

std::string DeviceFleet::refusal(const world::World& world, std::int64_t dt) {
  if (!world.terrain.empty()) return "the world has a terrain, which kernels do not follow";
  if (!world.ramps.empty()) return "the world has roads above the floor, which kernels do not follow";
  const double seconds = 1e-9 * static_cast<double>(dt);
  for (const world::Mover& mover : world.movers) {
    if (!mover.dynamics.name.empty())
      return fmt::format("'{}' moves by dynamics \"{}\", which kernels do not compute", mover.name,
                         mover.dynamics.name);
    const MotionBound bound = motion_bound(mover);
    const double turn = bound.turn * seconds, steps = bound.steps(seconds);
    if (!(std::abs(mover.X_WM.yaw) + turn < kMostTurn))
      return fmt::format("'{}' may turn by {:.3g} rad per tick; kernels turn by less than {:.0e}", mover.name, turn,
                         kMostTurn);
    if (!(steps < kMostSteps))
      return fmt::format("'{}' may move {:.0f} substeps of {:.3g} m per tick; kernels move less than {}", mover.name,
                         steps, bound.step, kMostSteps);
  }
  return "";
}

struct DeviceFleet::Tables {
  Tables(const world::World& world, gpu::Device& device)
      : Tables(world, fleet_tables(world), std::max<std::size_t>(world.movers.size(), 1), device) {}
  Tables(const world::World& world, const FleetTables& fixed, std::size_t rows, gpu::Device& device);

  void record(const std::function<void(gpu::Batch&)>& more = {});
  void bind(Kernel& kernel, std::span<const std::uint32_t> spirv);
  /// Copies a part of a table before the next submission of any batch.
  void upload(const Buffer& table, std::size_t offset, std::size_t size) { changes.push_back({&table, offset, size}); }
  void run(gpu::Batch& submission);

  Buffer tick, commands, drives, bodies, footprints, edges, walls, nodes, borders, absent;
  Buffer poses, proposed_poses, motions, proposed_motions, shared_states, own_states, struck, buckets, places, counts;
  Kernel start, index, advance, commit, contacts;
  gpu::Batch moving, staying, reading;
  std::vector<MotionBound> bounds;
  struct Change {
    const Buffer* table;
    std::size_t offset, size;
  };
  std::vector<Change> changes;
};

DeviceFleet::Tables::Tables(const world::World& world, const FleetTables& fixed, std::size_t rows, gpu::Device& device)
    : tick(table_of(device, "tick", Role::upload, std::vector<FleetTick>(1))),
      commands(table_of(device, "commands", Role::upload, std::vector<FleetCommand>(rows))),
      drives(table_of(device, "drives", Role::upload, fixed.drives)),
      bodies(table_of(device, "bodies", Role::upload, fixed.bodies)),
      footprints(table_of(device, "footprints", Role::upload, fixed.footprints)),
      edges(table_of(device, "edges", Role::upload, fixed.edges)),
      walls(table_of(device, "walls", Role::upload, fixed.walls.walls)),
      nodes(table_of(device, "tree of walls", Role::upload, fixed.walls.nodes)),
      borders(table_of(device, "borders of contact sectors", Role::upload, fixed.borders)),
      absent(table_of(device, "absent movers", Role::upload, std::vector<std::uint32_t>(rows))),
      poses(table_of(device, "poses", Role::download, load_poses(world))),
      proposed_poses(table_of(device, "proposed poses", Role::download, load_poses(world))),
      motions(table_of(device, "motions", Role::download, std::vector<FleetMotion>(rows))),
      proposed_motions(table_of(device, "proposed motions", Role::download, std::vector<FleetMotion>(rows))),
      shared_states(table_of(device, "shared states", Role::download, std::vector<FleetShared>(rows))),
      own_states(table_of(device, "own states", Role::download, std::vector<FleetOwn>(rows, {SF_FLEET_DONE, 0, 0, 0}))),
      struck(table_of(device, "struck movers", Role::download, std::vector<std::uint32_t>(rows))),
      buckets(table_of(device, "grid of movers", Role::download, std::vector<std::uint32_t>(std::bit_ceil(2 * rows)))),
      places(table_of(device, "places in the grid", Role::download, std::vector<FleetPlace>(rows))),
      counts(table_of(device, "group counts", Role::upload, std::vector<std::uint32_t>(4))),
      start(device, "fleet start", fleet_start_comp_spv, loop_constants(device)),
      index(device, "fleet index", fleet_index_comp_spv, loop_constants(device)),
      advance(device, "fleet advance", fleet_advance_comp_spv, loop_constants(device)),
      commit(device, "fleet commit", fleet_commit_comp_spv, loop_constants(device)),
      contacts(device, "fleet contacts", fleet_contacts_comp_spv, loop_constants(device)),
      moving(device),
      staying(device),
      reading(device),
      bounds(motion_bounds(world)) {
  const auto movers = static_cast<std::uint32_t>(world.movers.size());
  FleetTick& now = tick.host<FleetTick>()[0];
  now.movers = movers;
  now.copy_movers = std::max(movers / std::max(world.copies, 1u), 1u);
  now.nodes = fixed.walls.count;
  now.buckets = static_cast<std::uint32_t>(buckets.texels());
  for (const MotionBound& bound : bounds) now.widest = std::max(now.widest, bound.radius);
  write_counts(gpu::groups_for(movers * std::size_t{loop_constants(device)[0]}, start.group_size()), counts);
  bind(start, fleet_start_comp_spv), bind(index, fleet_index_comp_spv), bind(advance, fleet_advance_comp_spv);
  bind(commit, fleet_commit_comp_spv), bind(contacts, fleet_contacts_comp_spv);
  record();
  for (const Buffer* table : {&commands, &drives, &bodies, &footprints, &edges, &walls, &nodes, &borders, &absent,
                              &poses, &motions, &own_states, &struck, &counts})
    upload(*table, 0, table->bytes());
}

/// Binds the tables that the kernel uses.
void DeviceFleet::Tables::bind(Kernel& kernel, std::span<const std::uint32_t> spirv) {
  const std::vector<gpu::TableBinding> all{{"tick", &tick},
                                           {"commands", &commands},
                                           {"drives", &drives},
                                           {"bodies", &bodies},
                                           {"footprints", &footprints},
                                           {"edges", &edges},
                                           {"walls", &walls},
                                           {"nodes", &nodes},
                                           {"borders", &borders},
                                           {"absent", &absent},
                                           {"poses", &poses},
                                           {"proposed_poses", &proposed_poses},
                                           {"motions", &motions},
                                           {"proposed_motions", &proposed_motions},
                                           {"shared_states", &shared_states},
                                           {"own_states", &own_states},
                                           {"struck", &struck},
                                           {"buckets", &buckets},
                                           {"places", &places}};
  std::vector<gpu::TableBinding> used;
  for (const gpu::KernelTable& declared : gpu::interface_of(spirv).tables)
    used.push_back(*std::ranges::find(all, declared.name, &gpu::TableBinding::name));
  kernel.bind(used);
}

/// @param more records kernels after the motion
void DeviceFleet::Tables::record(const std::function<void(gpu::Batch&)>& more) {
  moving.begin();
  const auto dispatch = [&](const Kernel& kernel) {
    moving.dispatch(kernel, counts, 0);
    moving.barrier();
  };
  dispatch(start);
  dispatch(index);
  for (std::uint32_t round = 0; round < SF_FLEET_ROUNDS; ++round) {
    dispatch(advance);
    dispatch(advance);
    dispatch(commit);
  }
  dispatch(contacts);
  dispatch(contacts);
  if (more) more(moving);
  moving.end();
  staying.begin();
  if (more) more(staying);
  staying.end();
  reading.begin();
  reading.end();
}

void DeviceFleet::Tables::run(gpu::Batch& submission) {
  for (const auto& [table, offset, size] : changes) submission.upload(*table, offset, size);
  changes.clear();
  submission.run();
}

DeviceFleet::DeviceFleet(const world::World& world, gpu::Device& device)
    : reports_(states_at_load(world)), contacts_(reports_.size()) {
  SF_CHECK(!device.is_host(), "a DeviceFleet on the host");
  tables_ = std::make_unique<Tables>(world, device);
}

DeviceFleet::~DeviceFleet() = default;

void DeviceFleet::then(const std::function<void(gpu::Batch&)>& record, std::function<void(gpu::Batch&)> prepare) {
  tables_->record(record);
  prepare_ = std::move(prepare);
}

gpu::Buffer& DeviceFleet::commands() { return tables_->commands; }
const gpu::Buffer& DeviceFleet::poses() const { return tables_->poses; }
const gpu::Buffer& DeviceFleet::motions() const { return tables_->motions; }
const gpu::Buffer& DeviceFleet::own_states() const { return tables_->own_states; }
const gpu::Buffer& DeviceFleet::absent() const { return tables_->absent; }

void DeviceFleet::set_commands(std::span<const base::Twist> commands) {
  SF_CHECK(commands.size() == reports_.size(), std::to_string(commands.size()) + " commands");
  Buffer& table = tables_->commands;
  std::ranges::transform(commands, table.host<FleetCommand>().begin(), [](const base::Twist& v) {
    return FleetCommand{v.forward, v.left, v.turn, 0.0};
  });
  upload_commands(0, commands.size());
}

void DeviceFleet::upload_commands(std::size_t first, std::size_t count) {
  tables_->upload(tables_->commands, first * sizeof(FleetCommand), count * sizeof(FleetCommand));
}

void DeviceFleet::set_absent(std::uint32_t row, bool gone) {
  Buffer& table = tables_->absent;
  table.host<std::uint32_t>()[row] = gone ? 1 : 0;
  tables_->upload(table, row * sizeof(std::uint32_t), sizeof(std::uint32_t));
}

void DeviceFleet::set_state(const base::Report& report, bool contact) {
  const std::uint32_t row = report.mover;
  const auto set = [&]<class Record>(Buffer& table, const Record& record) {
    table.host<Record>()[row] = record;
    tables_->upload(table, row * sizeof record, sizeof record);
  };
  const base::Twist& v = report.velocity;
  set(tables_->poses, pose_record(report.X_WM));
  set(tables_->motions, FleetMotion{v.forward, v.left, v.turn, 0.0, 0, 0, 0, 0});
  set(tables_->own_states, FleetOwn{SF_FLEET_DONE, contact ? 1u : 0u, report.contact_mask, SF_ROUND_OUT});
}

void DeviceFleet::move(std::int64_t dt) {
  SF_CHECK(dt > 0, "dt " + std::to_string(dt));
  FleetTick& now = tables_->tick.host<FleetTick>()[0];
  now.seconds = 1e-9 * static_cast<double>(dt);
  now.farthest = 0.0;
  for (const MotionBound& bound : tables_->bounds) {
    SF_CHECK(bound.steps(now.seconds) < kMostSteps, "dt " + std::to_string(dt));
    now.farthest = std::max(now.farthest, bound.travel(now.seconds));
  }
  now.cell = 4.0 * (now.widest + now.farthest) + 1e-3;
  tables_->upload(tables_->tick, 0, tables_->tick.bytes());
  if (prepare_) prepare_(tables_->moving);
  tables_->run(tables_->moving);
  for (base::Report& report : reports_) report.time += dt;
}

void DeviceFleet::stay() {
  if (prepare_) prepare_(tables_->staying);
  tables_->run(tables_->staying);
}

std::span<const base::Report> DeviceFleet::reports() {
  Tables& t = *tables_;
  for (const Buffer* table : {&t.poses, &t.motions, &t.own_states}) t.reading.download(*table, 0, table->bytes());
  t.reading.run();
  const auto poses = t.poses.host<FleetPose>();
  const auto motions = t.motions.host<FleetMotion>();
  const auto own = t.own_states.host<FleetOwn>();
  for (std::size_t row = 0; row < reports_.size(); ++row) {
    if (own[row].phase == SF_FLEET_FAILED)
      throw base::DeviceError(
          fmt::format("mover {} met more obstacles in a tick than this device can test; move this "
                      "world on the host",
                      row));
    const FleetPose& p = poses[row];
    const FleetMotion& m = motions[row];
    reports_[row].X_WM = {p.x, p.y, p.z, p.yaw};
    reports_[row].velocity = {m.forward, m.left, m.turn};
    reports_[row].contact_mask = own[row].mask;
    contacts_[row] = own[row].contact != 0 ? 1 : 0;
  }
  return reports_;
}

}  // namespace sf::robots
