#include "world/stage/mover_entities.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <initializer_list>
#include <map>

namespace sf::world {

namespace {

constexpr double kMaxTagReach = 100.0;  // [m] keeps the speed of a model plausible when its tag turns fast

std::optional<std::uint32_t> number_of(std::string_view digits) {
  if (digits.empty() || digits.size() > 9) return std::nullopt;
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

// -------------------------------------------------------------------------------------------------------------

void read_bounds(const StageContext& context, const Entity& entity, Mover& mover) {
  mover.max_forward = 1.0;  // Stage's default
  const auto bounds = tuple(context, entity, "velocity_bounds", 2, "[xmin xmax ymin ymax zmin zmax yawmin yawmax]");
  if (!bounds) return;
  const SourceLocation at = find(entity, "velocity_bounds")->at;
  mover.max_forward = to_metres(context, at, (*bounds)[1]);
  if (bounds->size() >= 8) mover.max_turn = context.radians_per_unit * (*bounds)[7];
  if (!(mover.max_forward > 0.0) || !(mover.max_turn > 0.0 && mover.max_turn <= 1e6)) {
    fail(context, at, "'velocity_bounds' expects a robot that can move: xmax (2nd) and yawmax (8th) above zero");
  }
}

void read_accelerations(const StageContext& context, const Entity& entity, Mover& mover) {
  const char* key = "acceleration_bounds";
  const auto bounds = tuple(context, entity, key, 2, "[xmin xmax ymin ymax zmin zmax yawmin yawmax]");
  if (!bounds) return;
  const SourceLocation at = find(entity, key)->at;
  mover.max_acceleration = to_metres(context, at, (*bounds)[1]);
  if (bounds->size() >= 8) mover.max_turn_acceleration = context.radians_per_unit * (*bounds)[7];
  if (!(mover.max_acceleration > 0.0) || !(mover.max_turn_acceleration > 0.0)) {
    fail(context, at,
         "'acceleration_bounds' expects a robot that can speed up: xmax (2nd) and yawmax (8th) above zero");
  }
}

Drive drive_of(const StageContext& context, const Entity& entity) {
  const std::string drive = text(context, entity, "drive", "diff");
  if (drive == "diff") return Drive::differential;
  if (drive == "omni") return Drive::omni;
  if (drive == "car") return Drive::car;
  if (drive == "skid") return Drive::skid;
  fail(context, find(entity, "drive")->at,
       fmt::format("'drive' is \"{}\"; expected \"diff\", \"omni\", \"car\" or \"skid\"", drive));
}

DriverModel driver_model_of(const StageContext& context, const Entity& entity) {
  const std::string law = text(context, entity, "command_law", "direct");
  if (law == "direct") return DriverModel::direct;
  if (law == "player_create") return DriverModel::player_create;
  fail(context, find(entity, "command_law")->at,
       fmt::format("'command_law' is \"{}\"; expected \"direct\" or \"player_create\"", law));
}

}  // namespace

std::string controller_of(BuildState& b, const Entity& entity) {
  const Property* property = find(entity, "ctrl");
  if (property == nullptr || property->values.size() != 1) return {};
  const std::string& said = property->values.front().text;
  const std::string word = said.substr(0, said.find(' '));
  if (word == "wander") return word;
  if (!word.empty() && b.warned_types.insert("ctrl " + word).second)
    warn(b.context, property->at,
         fmt::format("ctrl \"{}\" names a plug-in of Stage, which is not run; choose a controller with --controller "
                     "NAME, or write ctrl \"wander\"",
                     word));
  return {};
}

std::optional<PacketId> packet_id_of(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  for (const std::string_view robot : {"roomba", "pioneer", "khepera"}) {
    if (!name.starts_with(robot)) continue;
    if (const auto number = number_of(name.substr(robot.size()))) return PacketId{*number, false};
  }
  if (!name.starts_with("tag")) return std::nullopt;
  const auto number = number_of(name.substr(3));
  if (!number || *number == 0) return std::nullopt;
  return PacketId{*number, true};
}

Pose tag_pose_of(StageContext& context, const Entity& entity, bool is_tag) {
  const Property* said = find(entity, "tag_pose");
  if (said == nullptr) return {};
  const Pose X_MT = pose(context, entity, "tag_pose");
  if (length(glm::dvec2{X_MT.x, X_MT.y}) > kMaxTagReach || std::abs(X_MT.z) > kMaxTagReach)
    fail(context, said->at, fmt::format("'tag_pose' expects a tag within {} m of its model's origin", kMaxTagReach));
  if (is_tag) return X_MT;
  warn(context, said->at,
       "'tag_pose' is ignored: expected it on a model named tag<N> (N from 1) that nothing carries, which follows tag "
       "packets");
  return {};
}

std::uint32_t add_mover(BuildState& b, const Entity& entity, const Model& model, std::optional<PacketId> packet_id) {
  Mover mover;
  mover.name = model.name;
  mover.model = static_cast<std::uint32_t>(b.world.models.size());
  mover.X_WM = model.X_WM;
  mover.is_tag = packet_id && packet_id->is_tag;
  mover.drive = drive_of(b.context, entity);
  mover.driver_model = driver_model_of(b.context, entity);
  mover.wheelbase = above_zero(b.context, entity, "wheelbase", mover.wheelbase);
  mover.track = above_zero(b.context, entity, "track", mover.track);
  read_bounds(b.context, entity, mover);
  read_accelerations(b.context, entity, mover);
  b.world.movers.push_back(std::move(mover));
  b.numbers.push_back(packet_id ? std::optional(packet_id->number) : std::nullopt);
  b.locations.push_back(entity.at);
  return static_cast<std::uint32_t>(b.world.movers.size() - 1);
}

void number_movers(BuildState& b) {
  std::map<std::pair<bool, std::uint32_t>, std::uint32_t> taken;
  auto& movers = b.world.movers;
  for (std::uint32_t m = 0; m < movers.size(); ++m) {
    if (!b.numbers[m]) continue;
    movers[m].id = *b.numbers[m];
    const auto [first, fresh] = taken.try_emplace({movers[m].is_tag, movers[m].id}, m);
    if (fresh) continue;
    fail(b.context, b.locations[m],
         fmt::format("'{}' and '{}' both follow the packets of {} {}; give each its own number",
                     movers[first->second].name, movers[m].name, movers[m].is_tag ? "tag" : "robot", movers[m].id));
  }
  std::uint32_t next = 0;
  for (std::uint32_t m = 0; m < movers.size(); ++m) {
    if (b.numbers[m]) continue;
    while (taken.contains({false, next})) ++next;
    movers[m].id = next++;
  }
}

}  // namespace sf::world
