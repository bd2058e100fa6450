#include "world/magnet_row.h"

#include <cmath>

#include "world/devices.h"

namespace sf::world {

namespace {

constexpr double kMostMagnets = 1e6;

}  // namespace

std::optional<MagnetRow> read_magnet_row(const Source& source, const Entity& entity) {
  MagnetRow row;
  row.spacing = length(source, entity, "magnet_spacing", 0.0);
  const double moment = number(source, entity, "magnetic_moment", 0.0);
  if (row.spacing == 0.0 && moment == 0.0) return std::nullopt;
  if (!(row.spacing > 0.0 && moment != 0.0 && std::abs(moment) <= kMostMoment))
    fail(source, entity.at, "magnets need both a 'magnetic_moment' other than 0 and a 'magnet_spacing' above zero");
  row.moment = kMomentUnit * moment;
  const auto size = tuple(source, entity, "magnet_size", 2, "[width length]").value_or(std::vector<double>{0.025, 0.1});
  row.width = source.metres * size[0];
  row.length = source.metres * size[1];
  if (!(row.width > 0.0 && row.length >= 0.0))
    fail(source, find(entity, "magnet_size")->at, "'magnet_size' expects [width length] above zero");
  row.top = length(source, entity, "magnet_top", 0.0);
  return row;
}

void place_magnets(Building& b, const Entity& entity, const MagnetRow& row, double length,
                   const std::function<Pose(double)>& along) {
  if (length / row.spacing + static_cast<double>(b.world.magnets.size()) > kMostMagnets)
    fail(b.source, place_of(entity, "magnet_spacing"),
         "'magnet_spacing' gives more than a million magnets; expected a larger one");
  const auto model = static_cast<std::uint32_t>(b.world.models.size() - 1);
  // The last one stands at the very end, where the length is a multiple of the spacing but for rounding.
  for (double k = 0.0; k * row.spacing <= length * (1.0 + 1e-12); ++k) {
    const Pose X = along(k * row.spacing);
    b.world.magnets.push_back({{X.x, X.y}, X.z + row.top - 0.5 * row.length, row.moment, 0.5 * row.width, model});
  }
}

}  // namespace sf::world
