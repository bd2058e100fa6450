#include "world/stage/magnet_row.h"

#include <cmath>

#include "world/stage/attached_devices.h"

namespace sf::world {

namespace {

constexpr double kMaxMagnets = 1e6;

}  // namespace

std::optional<MagnetRow> read_magnet_row(StageContext& context, const Entity& entity) {
  MagnetRow row;
  row.spacing = length(context, entity, "magnet_spacing", 0.0);
  const double moment = number(context, entity, "magnetic_moment", 0.0);
  if (row.spacing == 0.0 && moment == 0.0) return std::nullopt;
  if (!(row.spacing > 0.0 && moment != 0.0 && std::abs(moment) <= kMaxMoment))
    fail(context, entity.at, "magnets require both a 'magnetic_moment' other than 0 and a 'magnet_spacing' above zero");
  row.moment = kMomentUnit * moment;
  const auto size =
      tuple(context, entity, "magnet_size", 2, "[width length]").value_or(std::vector<double>{0.025, 0.1});
  row.width = context.metres_per_unit * size[0];
  row.length = context.metres_per_unit * size[1];
  if (!(row.width > 0.0 && row.length >= 0.0))
    fail(context, find(entity, "magnet_size")->at, "'magnet_size' expects [width length] above zero");
  row.top = length(context, entity, "magnet_top", 0.0);
  return row;
}

void place_magnets(BuildState& b, const Entity& entity, const MagnetRow& row, double length,
                   const std::function<Pose(double)>& along) {
  if (length / row.spacing + static_cast<double>(b.world.magnets.size()) > kMaxMagnets)
    fail(b.context, location_of(entity, "magnet_spacing"),
         "'magnet_spacing' gives more than a million magnets; expected a larger one");
  const auto model = static_cast<std::uint32_t>(b.world.models.size() - 1);
  // The tolerance keeps the last magnet at the very end if the length is a multiple of the spacing except for rounding.
  for (double k = 0.0; k * row.spacing <= length * (1.0 + 1e-12); ++k) {
    const Pose X = along(k * row.spacing);
    b.world.magnets.push_back({{X.x, X.y}, X.z + row.top - 0.5 * row.length, row.moment, 0.5 * row.width, model});
  }
}

}  // namespace sf::world
