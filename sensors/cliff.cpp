#include "sensors/cliff.h"

#include "sensors/elements.h"
#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"

namespace sf::sensors {

namespace {

base::BoxTree boxes_of(std::span<const world::FloorHole> drops) {
  std::vector<base::Box> boxes;
  for (const world::FloorHole& drop : drops) {
    base::Box box = base::empty_box();
    for (const glm::dvec2& p : drop.outline) box = base::united(box, {p, p});
    boxes.push_back(box);
  }
  return base::BoxTree(boxes);
}

/// Returns true when the edge ab crosses the ray from `p` along +x. Both ends are taken relative to `p` and in a fixed
/// order, so polygons that share the edge get the same result.
bool passes(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) {
  if ((a.y <= p.y) == (b.y <= p.y)) return false;
  if (a.y > b.y) std::swap(a, b);
  return base::cross(b - a, p - a) > 0.0;
}

/// The points of a sensor, in its frame.
using Points = std::vector<Pose>;

class Cliffs : public HostBackend {
 public:
  Cliffs(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, cliff_type, sensors),
        drop_offs_(context.world.floor_holes),
        points_(sensors.settings_as<Points>()) {}

 private:
  void measure(std::span<const HostSample> samples) const override;

  DropOffIndex drop_offs_;
  const std::vector<Points>& points_;  ///< per row
};

ParsedSensors parse_cliffs(const world::World& world) {
  return parse_each(world, cliff_type, [](const world::Sensor& sensor, SensorSpec& row) {
    Points points = read_elements(sensor, kMostCliffPoints);
    row.elements = static_cast<std::uint32_t>(points.size());
    row.limit = 1.0;
    row.reach = 0.0;
    return points;
  });
}

void Cliffs::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const auto& points = points_[sample.row];
    for (std::size_t i = 0; i < points.size(); ++i)
      sample.values[i] = drop_offs_.hold(base::transform(sample.X_WS, {points[i].x, points[i].y})) ? 1.0 : 0.0;
  }
}

constexpr std::string_view kKeys[] = {"scount", "spose[]", "spose3[]"};
constexpr Column kColumns[] = {{"cliff", 1, true}};
constexpr PlainNumber kNumbers[] = {{1.0, 0.0, 1.0}};
constexpr PlainForm kForm{kCliff, "cliff", kNumbers};

}  // namespace

bool holds(std::span<const glm::dvec2> outline, glm::dvec2 p) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) inside ^= passes(outline[i], outline[(i + 1) % outline.size()], p);
  return inside;
}

DropOffIndex::DropOffIndex(std::span<const world::FloorHole> drops) : drop_offs_(drops), boxes_(boxes_of(drops)) {}

bool DropOffIndex::hold(glm::dvec2 p) const {
  return boxes_.any(base::box_around(p, 0.0), [&](std::uint32_t i) { return holds(drop_offs_[i].outline, p); });
}

constinit const SensorType cliff_type = plain<kForm>({
    .word = {"cliff", kKeys},
    .base_port = 42000,
    .list = "points",
    .columns = kColumns,
    .parse = parse_cliffs,
    .make = make_backend<Cliffs>,
});

}  // namespace sf::sensors
