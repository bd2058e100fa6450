#include "sensors/cliff.h"

#include "sensors/drops.h"
#include "sensors/elements.h"
#include "sensors/host_instruments.h"
#include "sensors/plain_packets.h"

namespace sf::sensors {

namespace {

class Cliffs : public HostInstruments {
 public:
  explicit Cliffs(const SensorContext& context);

 private:
  void measure(std::span<const Sight> sights) const override;

  Drops drops_;
  std::vector<std::vector<Pose>> points_;  ///< per row, in the sensor's frame
};

std::vector<SensorRow> rows_of(const world::World& world) {
  std::vector<SensorRow> rows;
  for_each_sensor(world, cliff_kind, [&](const Fitted& fitted) {
    rows.push_back(fitted.row);
    rows.back().elements = static_cast<std::uint32_t>(read_elements(fitted.settings, kMostCliffPoints).size());
    rows.back().limit = 1.0;
  });
  return rows;
}

Cliffs::Cliffs(const SensorContext& context)
    : HostInstruments(context, cliff_kind, rows_of(context.world)), drops_(context.world.floor_holes) {
  for_each_sensor(context.world, cliff_kind, [this](const Fitted& fitted) {
    points_.push_back(read_elements(fitted.settings, kMostCliffPoints));
  });
}

void Cliffs::measure(std::span<const Sight> sights) const {
  for (const Sight& sight : sights) {
    const auto& points = points_[sight.row];
    for (std::size_t i = 0; i < points.size(); ++i)
      sight.values[i] = drops_.hold(base::transform(sight.X_WS, {points[i].x, points[i].y})) ? 1.0 : 0.0;
  }
}

constexpr std::string_view kKeys[] = {"scount", "spose[]", "spose3[]"};
constexpr Column kColumns[] = {{"cliff", 1, true}};
constexpr PlainNumber kNumbers[] = {{1.0, 0.0, 1.0}};
constexpr PlainForm kForm{kCliff, "cliff", kNumbers};

}  // namespace

constinit const SensorKind cliff_kind = plain<kForm>({
    .word = {"cliff", kKeys},
    .base_port = 42000,
    .list = "points",
    .columns = kColumns,
    .rows = rows_of,
    .make = make_instruments<Cliffs>,
});

}  // namespace sf::sensors
