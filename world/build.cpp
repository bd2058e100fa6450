#include "world/stage.h"

#include <fmt/format.h>

#include <filesystem>

#include "world/building.h"
#include "world/free_space.h"
#include "world/keys.h"
#include "world/light_plan.h"
#include "world/movers.h"

namespace sf::world {

namespace {

void read_units(Source& source, const Entity& root) {
  const std::string length_unit = text(source, root, "unit_length", "m");
  if (length_unit == "cm") {
    source.metres = 0.01;
  } else if (length_unit == "mm") {
    source.metres = 0.001;
  } else if (length_unit != "m") {
    fail(source, find(root, "unit_length")->at,
         fmt::format("'unit_length' is \"{}\"; expected \"m\", \"cm\" or \"mm\"", length_unit));
  }
  const std::string angle_unit = text(source, root, "unit_angle", "degrees");
  if (angle_unit == "radians") {
    source.radians = 1.0;
  } else if (angle_unit != "degrees") {
    fail(source, find(root, "unit_angle")->at,
         fmt::format("'unit_angle' is \"{}\"; expected \"degrees\" or \"radians\"", angle_unit));
  }
}

double interval_of(const Source& source, const Entity& root) {
  const double milliseconds = number(source, root, "interval_sim", 100.0);
  if (milliseconds >= 0.001 && milliseconds <= 1e6) return milliseconds / 1000.0;
  fail(source, find(root, "interval_sim")->at,
       fmt::format("'interval_sim' is {}; expected milliseconds from 0.001 to 1000000", milliseconds));
}

double reach(const Source& source, const Entity& root, std::string_view key) {
  const double value = length(source, root, key, 0.0);
  if (value < 0.0) fail(source, find(root, key)->at, fmt::format("'{}' is {} m; expected 0 or more", key, value));
  return value;
}

void warn_of_misplaced(Building& b) {
  for (std::size_t row = 0; row < b.world.movers.size(); ++row) {
    const Mover& robot = b.world.movers[row];
    const std::string where = robot.is_tag ? "" : misplaced(b.world, robot, robot.X_WM);
    if (where.empty()) continue;
    warn(b.source, b.places[row],
         fmt::format("'{}' starts at ({:g}, {:g}), {}; expected a 'pose' in free space", robot.name, robot.X_WM.x,
                     robot.X_WM.y, where));
  }
}

}  // namespace

World build_world(const std::string& file, const std::string& content, const LoadOptions& options) {
  const Document document = parse(file, content);
  Building b{.options = options, .source = {document, 1.0, M_PI / 180.0, document.warnings}, .types = known_types()};
  b.types.insert(b.types.end(), document.macros.begin(), document.macros.end());

  read_units(b.source, document.root);
  check_keys(b.source, document.root, Where::world);
  b.world.file = file;
  b.world.name = text(b.source, document.root, "name", std::filesystem::path(file).stem().string());
  b.world.interval = interval_of(b.source, document.root);
  b.world.road_resolution = reach(b.source, document.root, "road_resolution");
  b.world.magnet_cutoff = reach(b.source, document.root, "magnet_cutoff");
  b.world.accuracy = accuracy(b.source, options, document.root, {options.accuracy, "", 0});
  Parent nowhere;
  add_children(b, document.root, Kind::unknown, nowhere);
  number_movers(b);
  check_stop_lines(b);

  finish(b.world);
  warn_of_misplaced(b);
  b.world.warnings = std::move(b.source.warnings);
  return std::move(b.world);
}

}  // namespace sf::world
