#include "apps/report.h"

#include <algorithm>
#include <cstdio>

namespace sf::apps {

void print_warnings(const std::string& file, const std::vector<world::Warning>& warnings) {
  constexpr std::size_t kFirst = 3;
  const std::size_t count = warnings.size();
  if (count == 0) return;
  std::fprintf(stderr, "sensorfarm: %zu %s%s\n", count, count == 1 ? "warning" : "warnings",
               count > kFirst ? (", the first 3 here, all with `sensorfarm check " + file + "`:").c_str() : ":");
  for (std::size_t i = 0; i < std::min(count, kFirst); ++i)
    std::fprintf(stderr, "%s:%d: warning: %s\n", warnings[i].file.c_str(), warnings[i].line,
                 warnings[i].message.c_str());
}

void print_damage(const record::Recording& recording) {
  for (const std::string& damage : recording.damage)
    std::fprintf(stderr, "sensorfarm: %s: %s\n", recording.file.c_str(), damage.c_str());
  if (recording.truncated)
    std::fprintf(stderr, "sensorfarm: %s was not finished; its %llu whole ticks are taken\n", recording.file.c_str(),
                 static_cast<unsigned long long>(recording.ticks));
}

std::size_t count_robots(const world::World& world) {
  std::size_t robots = 0;
  for (const world::Mover& mover : world.movers) robots += !mover.is_tag;
  return robots;
}

std::size_t count_docks(const world::World& world) {
  return static_cast<std::size_t>(
      std::count_if(world.emitters.begin(), world.emitters.end(),
                    [](const world::Emitter& e) { return e.kind == world::Emitter::Kind::dock; }));
}

std::size_t count_magnets(const world::World& world) {
  std::size_t magnets = world.magnets.size();
  for (const world::Mover& mover : world.movers) magnets += mover.magnets.size();
  return magnets;
}

}  // namespace sf::apps
