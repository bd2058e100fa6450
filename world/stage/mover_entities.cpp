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

/// Reads `random_pose` and `random_present`. @throws base::InputError for numbers out of range, and for a robot that
/// may be missing
RandomStart random_start_of(StageContext& context, const Entity& entity, bool is_tag) {
  RandomStart start;
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
  return find(entity, "random_pose") != nullptr || find(entity, "random_present") != nullptr;
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

std::uint32_t add_mover(BuildState& b, const Entity& entity, const Model& model, std::optional<PacketId> packet_id,
                        bool is_tag) {
  Mover mover;
  mover.name = model.name;
  mover.model = static_cast<std::uint32_t>(b.world.models.size());
  mover.X_WM = model.X_WM;
  mover.is_tag = is_tag;
  if (is_tag && names_model_controller(b, entity)) mover.drive = Drive::omni;
  mover.max_forward = 1.0;  // Stage's default
  read_keys(b.context, entity, mover);
  mover.random_start = random_start_of(b.context, entity, is_tag);
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
