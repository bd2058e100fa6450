#include "apps/commands/joining_robots.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/error.h"
#include "netio/packets.h"
#include "world/append_robot.h"

namespace sf::apps {

namespace {

struct Wish {
  std::string robot;
  std::uint32_t first = 0, last = 0;  ///< ids
};

[[noreturn]] void refuse(const std::string& wish, const std::string& why) {
  throw base::InputError(fmt::format("--join: '{}' {}", wish, why));
}

std::uint32_t id_in(const std::string& wish, const std::string& text) {
  std::uint32_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end != text.data() + text.size() || id > netio::kMaxId)
    refuse(wish, fmt::format("has the id '{}'; expected ROBOT=FIRST-LAST with ids from 0 to {}", text, netio::kMaxId));
  return id;
}

Wish read(const std::string& wish) {
  const std::size_t equals = wish.find('=');
  if (equals == std::string::npos || equals == 0)
    refuse(wish, "is no range of robots; expected ROBOT=FIRST-LAST, such as roomba1=100-149");
  const std::string ids = wish.substr(equals + 1);
  const std::size_t dash = ids.find('-');
  const std::uint32_t first = id_in(wish, ids.substr(0, dash));
  const std::uint32_t last = dash == std::string::npos ? first : id_in(wish, ids.substr(dash + 1));
  if (last < first) refuse(wish, "ends before it begins; expected ROBOT=FIRST-LAST");
  return {wish.substr(0, equals), first, last};
}

}  // namespace

std::vector<std::uint32_t> append_joining(world::World& world, const std::vector<std::string>& wishes) {
  std::vector<std::uint32_t> rows;
  for (const std::string& text : wishes) {
    const Wish wish = read(text);
    const std::uint32_t original = world::robot_like(world, wish.robot);
    if (std::size_t{wish.last - wish.first} + 1 + rows.size() > kMostJoining)
      refuse(text, fmt::format("makes more than {} robots that may join", kMostJoining));
    std::vector<std::uint32_t> ids;
    for (std::uint32_t id = wish.first; id <= wish.last; ++id) {
      const auto has = std::ranges::find_if(
          world.movers, [id](const world::Mover& mover) { return !mover.is_tag && mover.id == id; });
      if (has != world.movers.end()) refuse(text, fmt::format("contains the id {} of '{}'", id, has->name));
      ids.push_back(id);
    }
    std::uint32_t row = world::append_robots(world, original, ids);
    for (std::size_t k = 0; k < ids.size(); ++k) rows.push_back(row++);
  }
  return rows;
}

}  // namespace sf::apps
