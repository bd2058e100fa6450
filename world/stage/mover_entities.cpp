#include "world/stage/mover_entities.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "world/stage/ctrl.h"
#include "world/stage/read_keys.h"

namespace sf::world {

namespace {

constexpr double kMaxTagReach = 100.0;  // [m] limits the speed of a model when its tag turns fast

std::optional<std::uint32_t> number_of(std::string_view digits) {
  if (digits.empty() || digits.size() > 9) return std::nullopt;
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

/// Reads a part in [0, most] that a run loses at most.
double random_part(StageContext& context, const Entity& entity, std::string_view key, double most) {
  const Property* said = find(entity, key);
  if (said == nullptr) return 0.0;
  const double part = number(context, entity, key, 0.0);
  if (!(part >= 0.0 && part <= most))
    fail(context, said->at, fmt::format("'{}' is {:g}; expected a number from 0 to {:g}", key, part, most));
  return part;
}

/// Reads `random_size`. @throws base::InputError also for models whose size other tables depend on
glm::dvec3 random_size_of(StageContext& context, const Entity& entity, bool is_tag, const glm::dvec3& size) {
  const auto spread = tuple(context, entity, "random_size", 3, "[x y z]");
  if (!spread) return {};
  const SourceLocation at = find(entity, "random_size")->at;
  const glm::dvec3 most{to_metres(context, at, (*spread)[0]), to_metres(context, at, (*spread)[1]),
                        to_metres(context, at, (*spread)[2])};
  if (spread->size() > 3 || std::min({most.x, most.y, most.z}) < 0.0)
    fail(context, at, "'random_size' expects [x y z]: the largest differences from 'size', at least 0");
  if (!(most.x < size.x && most.y < size.y && (most.z < size.z || most.z == 0.0)))
    fail(context, at,
         fmt::format("'random_size' is [{:g} {:g} {:g}] m around a size of [{:g} {:g} {:g}] m; expected less than it",
                     most.x, most.y, most.z, size.x, size.y, size.z));
  const char* what = !is_tag                               ? "a robot, whose controllers use the size of the file"
                     : find(entity, "outlines") != nullptr ? "a model with a file of outlines"
                     : find(entity, "magnetic_moment") != nullptr || find(entity, "magneticmoment") != nullptr
                         ? "a magnet, which is at half of its height"
                     : find(entity, "fiducial_return") != nullptr
                         ? "a mark for fiducial finders, which is at half of its height"
                         : nullptr;
  if (what != nullptr)
    fail(context, at, fmt::format("'random_size' cannot be that of {}; expected it in another model", what));
  return most;
}

/// Reads `random_pose`, `random_present`, `random_size` and, of robots, `random_slip`, `random_acceleration` and
/// `random_noise`. @throws base::InputError for numbers out of range, and for a robot that may be missing
RandomStart random_start_of(StageContext& context, const Entity& entity, const Mover& mover, const glm::dvec3& size) {
  const bool is_tag = mover.is_tag;
  RandomStart start;
  start.size_spread = random_size_of(context, entity, is_tag, size);
  if (!is_tag) {
    start.slip = random_part(context, entity, "random_slip", kMostSlip);
    start.acceleration = random_part(context, entity, "random_acceleration", 1.0 - kLeastAcceleration);
    start.noise = random_part(context, entity, "random_noise", 1.0);
  }
  if (!mover.dynamics.name.empty() && (start.slip > 0.0 || start.acceleration > 0.0))
    fail(context, entity.at,
         fmt::format("'{}' has 'dynamics', whose slip and accelerations follow from forces; leave 'random_slip' and "
                     "'random_acceleration' out",
                     mover.name));
  if (start.acceleration > 0.0 && mover.max_acceleration == HUGE_VAL && mover.max_turn_acceleration == HUGE_VAL)
    fail(context, find(entity, "random_acceleration")->at,
         fmt::format("'random_acceleration' lowers acceleration_bounds, which '{}' has none of; expected these, too",
                     mover.name));
  if (const auto spread = tuple(context, entity, "random_pose", 3, "[x y yaw]")) {
    const SourceLocation at = find(entity, "random_pose")->at;
    start.spread = {to_metres(context, at, (*spread)[0]), to_metres(context, at, (*spread)[1]),
                    context.radians_per_unit * (*spread)[2]};
    if (spread->size() > 3 || std::min({start.spread.x, start.spread.y, start.spread.z}) < 0.0 ||
        !(start.spread.z <= 2.0 * M_PI))
      fail(context, at, "'random_pose' expects [x y yaw]: the largest distances from 'pose', at least 0");
  }
  if (const Property* said = find(entity, "random_present")) {
    start.presence = number(context, entity, "random_present", 1.0);
    if (!(start.presence >= 0.0 && start.presence <= 1.0))
      fail(context, said->at,
           fmt::format("'random_present' is {:g}; expected a probability from 0 to 1", start.presence));
    if (!is_tag) fail(context, said->at, "a robot cannot be missing; expected 'random_present' in another model");
  }
  return start;
}

}  // namespace

bool is_random(const Entity& entity) {
  return find(entity, "random_pose") != nullptr || find(entity, "random_present") != nullptr ||
         find(entity, "random_size") != nullptr;
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
  warn(
      context, said->at,
      "'tag_pose' is ignored: expected it on a free-standing model named tag<N> (N from 1), which follows tag packets");
  return {};
}

std::uint32_t add_mover(BuildState& b, const Entity& entity, const Model& model, const glm::dvec3& size,
                        std::optional<PacketId> packet_id, bool is_tag) {
  Mover mover;
  mover.name = model.name;
  mover.model = static_cast<std::uint32_t>(b.world.models.size());
  mover.X_WM = model.X_WM;
  mover.is_tag = is_tag;
  if (is_tag && names_model_controller(b, entity)) mover.drive = Drive::omni;
  mover.max_forward = 1.0;  // Stage's default
  read_keys(b.context, entity, mover);
  read_dynamics(b, entity, mover);
  mover.random_start = random_start_of(b.context, entity, mover, size);
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
  std::uint32_t next_robot = 0, next_tag = 1;
  for (std::uint32_t m = 0; m < movers.size(); ++m) {
    if (b.numbers[m]) continue;
    std::uint32_t& next = movers[m].is_tag ? next_tag : next_robot;
    while (taken.contains({movers[m].is_tag, next})) ++next;
    movers[m].id = next++;
  }
}

}  // namespace sf::world
