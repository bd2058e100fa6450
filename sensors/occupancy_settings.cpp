#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sensors/derived/wiring.h"
#include "sensors/infrared.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/occupancy.h"
#include "sensors/settings.h"
#include "sensors/sonar.h"

namespace sf::sensors {

namespace {

constexpr double kDefaultCell = 0.03;  // [m] same as in the thesis
constexpr std::uint32_t kDefaultWords = 30;
constexpr double kDefaultRate = 1.0;  // [Hz]
constexpr double kFarthestMap = 1e7;  // [m]
constexpr double kMostOdds = 32767.0;

std::uint32_t words_along(const world::Sensor& sensor, double count) {
  if (count >= 1.0 && count <= maps::kMaxWordColumns && count == std::floor(count))
    return static_cast<std::uint32_t>(count);
  refuse(sensor, "words",
         fmt::format("'words' has {:g}; expected whole numbers from 1 to {} (a word is 4 x 4 cells)", count,
                     maps::kMaxWordColumns));
}

/// Places a map of this size around `place`, aligned to multiples of the cell size, so that maps can be merged exactly.
void centre(maps::GridGeometry& geometry, const Pose& place) {
  geometry.left =
      geometry.cell * std::round(place.x / geometry.cell - 0.5 * static_cast<double>(maps::columns(geometry)));
  geometry.top = geometry.cell * std::round(place.y / geometry.cell + 0.5 * static_cast<double>(maps::rows(geometry)));
}

maps::GridGeometry grid_of(const world::Sensor& sensor, const Pose& place) {
  maps::GridGeometry geometry;
  geometry.cell = length(sensor, "cell", kDefaultCell, 1e-4, 1e3);
  if (const auto size = tuple(sensor, "words", 2, "[columns rows]")) {
    geometry.word_columns = words_along(sensor, (*size)[0]);
    geometry.word_rows = words_along(sensor, (*size)[1]);
  } else {
    geometry.word_columns = geometry.word_rows = kDefaultWords;
  }
  if (geometry.word_columns > maps::kMaxWords / geometry.word_rows)
    refuse(sensor, "words",
           fmt::format("a map of {} x {} words is too large; expected at most {} words in all: raise 'cell' or give "
                       "each robot a part",
                       geometry.word_columns, geometry.word_rows, maps::kMaxWords));
  centre(geometry, place);
  if (const auto offset = tuple(sensor, "offset", 2, "[x y]")) {
    geometry.left = -sensor.metres_per_unit * (*offset)[0];
    geometry.top = -sensor.metres_per_unit * (*offset)[1];
  }
  if (!maps::is_valid(geometry))
    refuse(sensor, "offset",
           fmt::format("a map more than {:g} m from the world's origin; change 'offset'", kFarthestMap));
  return geometry;
}

std::optional<maps::LogOddsUpdate> odds_of(const world::Sensor& sensor) {
  const auto said = tuple(sensor, "log_odds", 1, "0, 1 or [hit miss limit]");
  if (!said || (said->size() == 1 && said->front() == 0.0)) return std::nullopt;
  if (said->size() == 1 && said->front() == 1.0) return maps::LogOddsUpdate{};
  const auto fits = [](double v, double least) { return v == std::floor(v) && v >= least && v <= kMostOdds; };
  const auto& v = *said;
  if (v.size() != 3 || !fits(v[0], 0.0) || !fits(v[1], 0.0) || !fits(v[2], 1.0))
    refuse(sensor, "log_odds",
           fmt::format("'log_odds' expects 0, 1 or [hit miss limit] in whole numbers up to {:g}, such as [85 40 350]",
                       kMostOdds));
  return maps::LogOddsUpdate{static_cast<std::int32_t>(v[0]), static_cast<std::int32_t>(v[1]),
                             static_cast<std::int32_t>(v[2])};
}

constexpr std::size_t kMostSources = 4096;
constexpr const SensorType* kSourceTypes[] = {&laser_type, &sonar_type, &infrared_type};

/// The sensors of one type in a world.
struct SourceGroup {
  const SensorType* type;
  std::vector<SensorSpec> rows;
};

[[noreturn]] void refuse_source(const world::Sensor& sensor, std::string_view text, const std::string& why) {
  refuse(sensor, "sources", fmt::format("source '{}': {}", text, why));
}

void add_source(const world::Sensor& sensor, const world::World& world, std::uint32_t own, std::string_view text,
                std::span<const SourceGroup> groups, Occupancy& map) {
  const InputText parts = read_input(text);
  const auto group = std::ranges::find_if(groups, [&](const auto& g) { return is_called(*g.type, parts.type); });
  if (group == groups.end() || !parts.port.empty() || !parts.number)
    refuse_source(sensor, text, "expected \"[robot/]laser[:number]\", or a sonar or infrared");
  const std::size_t before = map.sources.size();
  std::string why;
  const std::vector<std::uint32_t> movers = movers_named(world, own, parts.robot, why);
  if (movers.empty()) refuse_source(sensor, text, why);
  for (const std::uint32_t m : movers) {
    const auto rows = std::ranges::equal_range(group->rows, m, {}, &SensorSpec::mover);
    if (*parts.number >= rows.size()) continue;
    const SensorSpec& row = rows[*parts.number];
    if (!(row.limit <= maps::kMaxRangeCells * map.settings.grid.cell))
      refuse(sensor, "cell",
             fmt::format("source '{}' has a range of {:g} m, which is more than {:g} cells of {:g} m; raise 'cell'",
                         row.name, row.limit, maps::kMaxRangeCells, map.settings.grid.cell));
    map.sources.push_back({group->type->id, m, *parts.number});
  }
  if (map.sources.size() == before)
    refuse_source(sensor, text, "there is no such sensor; sensors of one type are numbered per robot, from 0");
  if (map.sources.size() > kMostSources)
    refuse_source(sensor, text, fmt::format("a map has at most {} sources", kMostSources));
}

void read_sources(const world::Sensor& sensor, const world::World& world, std::uint32_t own,
                  std::span<const SourceGroup> groups, Occupancy& map) {
  const world::Setting& setting = *find(sensor, "sources");
  if (find(sensor, "laser") != nullptr) refuse(sensor, "laser", "a map has a 'laser' or 'sources'; remove one of them");
  if (!setting.numbers.empty() || setting.text.empty())
    refuse(sensor, "sources", "'sources' expects names of sensors, such as [\"laser\" \"sonar\" \"*/infrared\"]");
  if (find(sensor, "log_odds") != nullptr && !map.settings.odds)
    refuse(sensor, "log_odds", "a map from 'sources' always has log odds; expected 1 or [hit miss limit]");
  if (!map.settings.odds) map.settings.odds.emplace();
  for (std::string_view rest = setting.text; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    add_source(sensor, world, own, rest.substr(0, end), groups, map);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  std::ranges::sort(map.sources);
  const auto twice = std::ranges::unique(map.sources);
  map.sources.erase(twice.begin(), twice.end());
}

/// Returns the number of the laser that fills the map.
std::uint32_t laser_of(const world::Sensor& sensor, const world::Mover& mover, std::span<const SensorSpec> lasers) {
  if (lasers.empty())
    refuse(sensor, "laser", "a map requires a laser on the same robot; give it a laser( ) or remove the map");
  const world::Setting* named = find(sensor, "laser");
  if (named == nullptr) return 0;
  const auto found =
      std::find_if(lasers.begin(), lasers.end(), [&](const SensorSpec& laser) { return laser.name == named->text; });
  if (found != lasers.end()) return static_cast<std::uint32_t>(found - lasers.begin());
  std::string names;
  for (const SensorSpec& laser : lasers) names += (names.empty() ? "" : ", ") + laser.name;
  refuse(sensor, "laser", fmt::format("'{}' has no laser '{}'; it has {}", mover.name, named->text, names));
}

void fill_from(const world::Sensor& sensor, const SensorSpec& laser, MapSettings& settings) {
  settings.fov = laser.fov;
  settings.samples = laser.elements;
  settings.range_min = laser.range_min;
  settings.range_max = laser.limit;
  if (settings.samples > kMostMapBeams)
    refuse(
        sensor, "laser",
        fmt::format("laser '{}' has {} samples; maps support at most {}", laser.name, settings.samples, kMostMapBeams));
  if (!(settings.range_max <= maps::kMaxRangeCells * settings.grid.cell))
    refuse(sensor, "cell",
           fmt::format("laser '{}' has a range of {:g} m, which is more than {:g} cells of {:g} m; raise 'cell'",
                       laser.name, settings.range_max, maps::kMaxRangeCells, settings.grid.cell));
}

/// @param groups of kSourceTypes
Occupancy occupancy_of(const world::Sensor& sensor, const world::World& world, std::uint32_t m, std::uint32_t number,
                       std::span<const SourceGroup> groups) {
  const world::Mover& mover = world.movers[m];
  Occupancy map;
  map.row = common_spec(sensor, m, number);
  map.row.rate = rate_of(sensor, kDefaultRate);
  map.settings.grid = grid_of(sensor, mover.X_WM);
  map.settings.odds = odds_of(sensor);
  if (find(sensor, "sources") != nullptr) {
    read_sources(sensor, world, m, groups, map);
  } else {
    const std::span<const SensorSpec> lasers = std::ranges::equal_range(groups[0].rows, m, {}, &SensorSpec::mover);
    map.laser = laser_of(sensor, mover, lasers);
    require_level(world, lasers_of(mover)[map.laser], "an occupancy map");
    fill_from(sensor, lasers[map.laser], map.settings);
  }
  map.row.elements = maps::words(map.settings.grid);
  map.row.limit = 4294967295.0;
  map.row.reach = 0.0;
  map.row.across = map.settings.grid.word_columns;
  map.row.pitch = map.settings.grid.cell;
  return map;
}

}  // namespace

std::vector<Occupancy> occupancies_of(const world::World& world) {
  std::vector<Occupancy> all;
  std::vector<SourceGroup> groups;
  for_each_of(world, occupancy_type.word.type, [&](const world::Sensor& sensor, std::uint32_t m, std::uint32_t number) {
    if (all.empty())
      for (const SensorType* type : kSourceTypes) groups.push_back({type, type->parse(world).rows});
    all.push_back(occupancy_of(sensor, world, m, number, groups));
  });
  return all;
}

void require_own_sources(const world::World& world, std::span<const Occupancy> maps) {
  auto map = maps.begin();
  for_each_of(world, occupancy_type.word.type, [&](const world::Sensor& sensor, std::uint32_t mover, std::uint32_t) {
    const Occupancy& of = *map++;
    if (std::ranges::any_of(of.sources, [&](const RangeSensor& source) { return source.mover != mover; }))
      throw base::InputError(sensor.file, sensor.line,
                             fmt::format("map '{}' of '{}' has sources of other robots, which several processes cannot "
                                         "share: run it in one process",
                                         sensor.name, world.movers[mover].name));
  });
}

}  // namespace sf::sensors
