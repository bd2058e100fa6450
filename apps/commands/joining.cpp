#include "apps/commands/joining.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>

#include "apps/reports/text.h"
#include "base/error.h"
#include "netio/packets.h"
#include "server/signal_messages.h"
#include "server/wire_ids.h"
#include "world/append_object.h"
#include "world/roads/roads.h"

namespace sf::apps {

namespace {

using world::JoiningKind;

constexpr const char* kForm = "expected NAME=FIRST-LAST";

struct Wish {
  std::string name;
  std::uint32_t first = 0, last = 0;  ///< ids
};

[[noreturn]] void refuse(const std::string& wish, const std::string& why) {
  throw base::InputError(fmt::format("--join: '{}' {}", wish, why));
}

std::uint32_t id_in(const std::string& wish, const std::string& text) {
  std::uint32_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end != text.data() + text.size() || id > netio::kMaxId)
    refuse(wish, fmt::format("has the id '{}'; {} with ids from 0 to {}", text, kForm, netio::kMaxId));
  return id;
}

Wish read(const std::string& wish) {
  const std::size_t equals = wish.rfind('=');
  if (equals == std::string::npos || equals == 0)
    refuse(wish, fmt::format("is no range of ids; {}, such as roomba1=100-149", kForm));
  const std::string ids = wish.substr(equals + 1);
  const std::size_t dash = ids.find('-');
  const std::uint32_t first = id_in(wish, ids.substr(0, dash));
  const std::uint32_t last = dash == std::string::npos ? first : id_in(wish, ids.substr(dash + 1));
  if (last < first) refuse(wish, fmt::format("ends before it begins; {}", kForm));
  return {wish.substr(0, equals), first, last};
}

/// Returns the names of those that have an id, by id.
std::map<std::uint32_t, std::string> taken_ids(const world::World& world, JoiningKind kind) {
  std::map<std::uint32_t, std::string> taken;
  if (kind == JoiningKind::light) {
    const auto roads = world::roads_of(world);
    for (const server::Intersection& one : server::intersections_of(world, roads ? &*roads : nullptr))
      taken[one.id] = world.lights[one.lights.front()].name;
    return taken;
  }
  const server::WireNames names = server::wire_names(world);
  for (const auto& [id, row] : kind == JoiningKind::object ? names.tags : names.robots)
    taken[id] = world.movers[row].name;
  return taken;
}

std::vector<std::uint32_t> ids_of(const std::string& text, const Wish& wish, const world::World& world,
                                  JoiningKind kind) {
  if (kind == JoiningKind::object && wish.first < netio::kMinTag)
    refuse(text, fmt::format("has the id {}; tags have ids from {}", wish.first, netio::kMinTag));
  const auto taken = taken_ids(world, kind);
  const auto other = taken.lower_bound(wish.first);
  if (other != taken.end() && other->first <= wish.last)
    refuse(text, fmt::format("contains the id {} of '{}'", other->first, other->second));
  std::vector<std::uint32_t> ids(wish.last - wish.first + 1);
  std::iota(ids.begin(), ids.end(), wish.first);
  return ids;
}

}  // namespace

Joining append_joining(world::World& world, const std::vector<std::string>& wishes) {
  Joining joining;
  std::size_t outlines = 0;
  for (const std::string& text : wishes) {
    const Wish wish = read(text);
    const std::size_t count = std::size_t{wish.last - wish.first} + 1;
    const world::JoiningTemplate original = joining_template(world, wish.name);
    if (count + joining.rows.size() > kMostJoining)
      refuse(text, fmt::format("makes more than {} robots, objects and lights that may join", kMostJoining));
    outlines += count * outline_size(world, original);
    if (outlines > kMostJoiningOutlines)
      refuse(text, fmt::format("makes outlines of more than {} pieces in all", kMostJoiningOutlines));
    std::uint32_t row = world::append_joining(world, original, ids_of(text, wish, world, original.kind));
    for (std::size_t k = 0; k < count; ++k) joining.rows.push_back(row++);
    (original.kind == JoiningKind::robot    ? joining.robots
     : original.kind == JoiningKind::object ? joining.objects
                                            : joining.lights) += count;
  }
  return joining;
}

std::string joining_text(const Joining& joining) {
  std::vector<std::string> parts;
  if (joining.robots > 0) parts.push_back(counted(joining.robots, "robot"));
  if (joining.objects > 0) parts.push_back(counted(joining.objects, "object"));
  if (joining.lights > 0) parts.push_back(counted(joining.lights, "light"));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace sf::apps
