#include "world/stage/light_entities.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "world/roads/rndf_statement_reader.h"
#include "world/stage/read_keys.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMaxPhases = 100;
constexpr double kMaxSeconds = 1e6;

LightPhase read_phase(const StageContext& context, const Entity& entity, std::uint32_t i, std::uint32_t count) {
  const std::string key = fmt::format("phase[{}]", i);
  const Property* property = find(entity, key);
  if (property == nullptr)
    fail(context, find(entity, "phases")->at, fmt::format("'{}' is missing: 'phases' is {}", key, count));
  const auto& v = property->values;
  if (v.size() != 2 || !v[0].is_text || v[1].is_text)
    fail(context, property->at, fmt::format("'{}' expects [\"state\" seconds], such as [\"green\" 8]", key));
  if (!(v[1].number > 0.0 && v[1].number <= kMaxSeconds))
    fail(context, property->at,
         fmt::format("'{}' lasts {} s; expected more than 0, to {}", key, v[1].number, kMaxSeconds));
  const std::size_t state = word_row(context, property->at, key, v[0].text, words_of(LightState{}));
  return {static_cast<LightState>(state), v[1].number};
}

std::vector<LightPhase> read_phases(StageContext& context, const Entity& entity) {
  const std::uint32_t count = whole(context, entity, "phases", 0, 1, kMaxPhases);
  if (count == 0) fail(context, entity.at, "a light requires 'phases', and a phase[i] [\"state\" seconds] for each");
  std::vector<LightPhase> phases;
  for (std::uint32_t i = 0; i < count; ++i) phases.push_back(read_phase(context, entity, i, count));
  const std::string beyond = fmt::format("phase[{}]", count);
  if (const Property* extra = find(entity, beyond))
    warn(context, extra->at, fmt::format("'{}' is not used: 'phases' is {}", beyond, count));
  return phases;
}

/// Matches "3.1.11": segment, lane and point of a road network. Segment and point start at 1.
bool is_way_point(std::string_view name) {
  const auto id = read_point_id(name);
  return id && id->segment >= 1 && id->point >= 1 && std::max({id->segment, id->lane, id->point}) <= kMaxRoadNumber;
}

std::vector<std::string> read_stop_lines(const StageContext& context, const Entity& entity) {
  std::vector<std::string> points;
  std::istringstream names(text(context, entity, "stop_lines", ""));
  for (std::string name; names >> name;) {
    if (!is_way_point(name))
      fail(context, find(entity, "stop_lines")->at,
           fmt::format("'stop_lines' names '{}'; expected way-points such as \"3.1.11 4.2.5\"", name));
    points.push_back(name);
  }
  return points;
}

}  // namespace

void add_light(BuildState& b, const Entity& entity, const Model& model) {
  StageContext& context = b.context;
  if (model.mover != kNone) fail(context, entity.at, "a light cannot move; expected it outside moving models");
  Light light;
  light.name = model.name;
  light.model = static_cast<std::uint32_t>(b.world.models.size());
  light.X_WL = model.X_WM;
  const std::uint32_t lamps = whole(context, entity, "lamps", 3, 1, 3);
  if (lamps == 2) fail(context, find(entity, "lamps")->at, "'lamps' is 2; expected 1 or 3 a side");
  light.single = lamps == 1;
  light.phases = read_phases(context, entity);
  read_keys(context, entity, light);
  light.points = read_stop_lines(context, entity);
  const Property* stops = find(entity, "stop_lines");
  b.light_locations.push_back(stops != nullptr ? stops->at : entity.at);
  b.world.lights.push_back(std::move(light));
}

std::vector<Segment> light_shape(const Size& size, bool single) {
  std::vector<Segment> segments;
  const double neck = (single ? 0.8 : 0.6) * size.z;
  const auto add_box = [&](double x, double y, double z_min, double z_max) {
    const std::array<glm::dvec2, 4> corners{{{-x, -y}, {x, -y}, {x, y}, {-x, y}}};
    for (std::size_t i = 0; i < 4; ++i) {
      Segment side;
      side.a = corners[i];
      side.b = corners[(i + 1) % 4];
      side.z_min = z_min;
      side.z_max = z_max;
      segments.push_back(side);
    }
  };
  add_box(0.2 * size.x, 0.2 * size.y, 0.0, neck);
  add_box(0.5 * size.x, 0.5 * size.y, neck, size.z);
  return segments;
}

void check_stop_lines(BuildState& b) {
  if (b.world.road_files.empty()) return;
  for (std::size_t i = 0; i < b.world.lights.size(); ++i) {
    const Light& light = b.world.lights[i];
    for (const std::string& name : light.points) {
      const auto point = b.way_points.find(name);
      if (point == b.way_points.end())
        fail(b.context, b.light_locations[i],
             fmt::format("'{}' governs way-point {}, which no lane has; expected one of {}", light.name, name,
                         b.world.road_files.front()));
      if (!point->second)
        warn(b.context, b.light_locations[i],
             fmt::format("'{}' governs way-point {}, which has no stop line", light.name, name));
    }
  }
}

}  // namespace sf::world
