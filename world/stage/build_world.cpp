#include "world/stage/stage.h"

#include <fmt/format.h>

#include <filesystem>

#include "world/free_space.h"
#include "world/keys.h"
#include "world/outlines.h"
#include "world/stage/build_state.h"
#include "world/stage/light_entities.h"
#include "world/stage/mover_entities.h"
#include "world/stage/read_keys.h"

namespace sf::world {

namespace {

void read_units(StageContext& context, const Entity& root) {
  const std::string length_unit = text(context, root, "unit_length", "m");
  if (length_unit == "cm") {
    context.metres_per_unit = 0.01;
  } else if (length_unit == "mm") {
    context.metres_per_unit = 0.001;
  } else if (length_unit != "m") {
    fail(context, find(root, "unit_length")->at,
         fmt::format("'unit_length' is \"{}\"; expected \"m\", \"cm\" or \"mm\"", length_unit));
  }
  const std::string angle_unit = text(context, root, "unit_angle", "degrees");
  if (angle_unit == "radians") {
    context.radians_per_unit = 1.0;
  } else if (angle_unit != "degrees") {
    fail(context, find(root, "unit_angle")->at,
         fmt::format("'unit_angle' is \"{}\"; expected \"degrees\" or \"radians\"", angle_unit));
  }
}

void warn_of_starts(BuildState& b) {
  if (b.world.movers.empty()) return;
  const PlaceCheck check(b.world);
  for (std::size_t row = 0; row < b.world.movers.size(); ++row) {
    const std::string problem = check.start_problem(b.world.movers[row]);
    if (!problem.empty()) warn(b.context, b.locations[row], problem);
  }
}

}  // namespace

World build_world(const std::string& file, const std::string& content, const LoadOptions& options) {
  const Document document = parse(file, content);
  BuildState b{.options = options, .context = {document, 1.0, M_PI / 180.0, document.warnings}, .types = known_types()};
  b.types.insert(b.types.end(), document.macros.begin(), document.macros.end());

  read_units(b.context, document.root);
  check_keys(b.context, document.root, KeyScope::world);
  b.world.file = file;
  b.world.name = std::filesystem::path(file).stem().string();
  read_keys(b.context, document.root, b.world);
  b.world.accuracy = accuracy(b.context, options, document.root);
  Parent nowhere;
  add_children(b, document.root, nowhere);
  number_movers(b);
  check_stop_lines(b);

  if (!options.leave_outlines) read_unread(b.world);
  update_extent_and_hash(b.world);
  if (b.world.unread.empty()) warn_of_starts(b);
  b.world.warnings.insert(b.world.warnings.begin(), b.context.warnings.begin(), b.context.warnings.end());
  return std::move(b.world);
}

}  // namespace sf::world
