#include "apps/reports/report.h"

#include <algorithm>

#include "apps/reports/text.h"
#include "base/error.h"
#include "base/suggest.h"

namespace sf::apps {

void print_warnings(const std::string& file, const std::vector<world::Warning>& warnings) {
  constexpr std::size_t kFirst = 3;
  const std::size_t count = warnings.size();
  if (count == 0) return;
  std::string lines = warnings_text(std::span(warnings).first(std::min(count, kFirst)));
  lines.pop_back();  // `print_message` adds the line end
  print_message("{}{}:\n{}", counted(count, "warning"),
                count > kFirst ? fmt::format("; the first 3 follow, `sensorfarm check {}` lists all", file) : "",
                lines);
}

void print_never_valid(std::span<const std::string> lines) {
  constexpr std::size_t kFirst = 3;
  for (const std::string& line : lines.first(std::min(lines.size(), kFirst)))
    print_message("{}: its inputs had no values that it can use, or too old ones (docs/derived.md#types)", line);
  if (lines.size() > kFirst) print_message("the same holds for {}", counted(lines.size() - kFirst, "more sensor"));
}

std::string warnings_text(std::span<const world::Warning> warnings) {
  std::string text;
  for (const world::Warning& w : warnings)
    text += fmt::format("{}{}: warning: {}\n", w.file, w.line > 0 ? fmt::format(":{}", w.line) : "", w.message);
  return text;
}

void print_damage(const record::Recording& recording) {
  for (const std::string& damage : recording.damage) print_message("{}: {}", recording.file, damage);
  if (recording.truncated)
    print_message("{} was not finished; using its {} complete ticks", recording.file, recording.ticks);
}

std::size_t count_robots(const world::World& world) {
  std::size_t robots = 0;
  for (const world::Mover& mover : world.movers) robots += !mover.is_tag;
  return robots;
}

void refuse_robot(const world::World& world, const std::string& name, const std::vector<std::string_view>& names) {
  std::vector<std::string_view> robots;
  for (const world::Mover& mover : world.movers)
    if (!mover.is_tag) robots.push_back(mover.name);
  throw base::InputError(
      world.file, 0,
      fmt::format("has no robot '{}'{}", name, base::suggest(name, names, "it has " + list_names(robots))));
}

std::size_t count_docks(const world::World& world) {
  return static_cast<std::size_t>(
      std::count_if(world.emitters.begin(), world.emitters.end(),
                    [](const world::Emitter& e) { return e.kind == world::Emitter::Kind::dock; }));
}

std::size_t triangles_of(std::span<const world::Mesh> meshes) {
  std::size_t triangles = 0;
  for (const world::Mesh& mesh : meshes) triangles += mesh.corners.size() / 3;
  return triangles;
}

std::size_t count_magnets(const world::World& world) {
  std::size_t magnets = world.magnets.size();
  for (const world::Mover& mover : world.movers) magnets += mover.magnets.size();
  return magnets;
}

}  // namespace sf::apps
