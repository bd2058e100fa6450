#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>

#include "base/bytes.h"
#include "base/error.h"
#include "world/serialization.h"
#include "world/world.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMagic = 0x57574653u;  // "SFWW"
constexpr std::uint16_t kVersion = 4;
constexpr std::uint32_t kMaxSamples = 1'000'000;  // of a laser; the world of a recording is untrusted input

template <class Row>
void put_rows(base::ByteWriter& out, const std::vector<Row>& rows) {
  out.put(static_cast<std::uint32_t>(rows.size()));
  for (const Row& row : rows) put(out, row);
}

template <class Row, class Get>
void get_rows(base::ByteReader& in, std::vector<Row>& rows, std::size_t row_size, Get get) {
  rows.resize(get_count(in, row_size));
  for (Row& row : rows) row = get(in);
}

[[noreturn]] void refuse(const std::string& reason) { throw base::InputError("broken world snapshot: " + reason); }

// Checks that row numbers refer to existing rows. Users of a world rely on it.
void check_links(const World& world) {
  const auto models = world.models.size();
  const auto movers = world.movers.size();
  const auto known = [&](const auto& row) { return row.model < models; };
  bool good = std::all_of(world.walls.begin(), world.walls.end(), known);
  good &= std::all_of(world.magnets.begin(), world.magnets.end(), known);
  for (const Model& m : world.models)
    good &= (m.parent == kNone || m.parent < models) && (m.mover == kNone || m.mover < movers);
  for (const Mover& m : world.movers) {
    good &= m.model < models && std::all_of(m.body.begin(), m.body.end(), known);
    good &= std::all_of(m.magnets.begin(), m.magnets.end(), known);
  }
  good &= std::all_of(world.lights.begin(), world.lights.end(), known);
  good &= std::all_of(world.emitters.begin(), world.emitters.end(), known);
  good &= std::all_of(world.floor_holes.begin(), world.floor_holes.end(), known);
  if (!good) refuse("a row names a row that is not there");
}

bool finite(std::initializer_list<double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double number) { return std::isfinite(number); });
}
bool finite(const Pose& X) { return finite({X.x, X.y, X.z, X.yaw}); }
bool finite(const Segment& s) { return finite({s.a.x, s.a.y, s.b.x, s.b.y, s.z_min, s.z_max}); }
bool finite(const Magnet& m) { return finite({m.p.x, m.p.y, m.z, m.moment, m.radius}); }
bool finite(const Laser& l) {
  return finite(l.X_MS) && finite({l.fov, l.range_min, l.range_max, l.rate, l.phase, l.latency, l.noise.range_sigma,
                                   l.noise.range_proportional, l.noise.angle_sigma});
}
bool finite(const Sensor& s) {
  return finite(s.X_MS) && finite({s.height, s.metres_per_unit, s.radians_per_unit}) &&
         std::all_of(s.settings.begin(), s.settings.end(), [](const Setting& setting) {
           return std::all_of(setting.numbers.begin(), setting.numbers.end(),
                              [](double n) { return std::isfinite(n); });
         });
}
bool finite(const LaneMarking& marking) {
  return finite({marking.width}) && std::all_of(marking.line.begin(), marking.line.end(), [](glm::dvec2 p) {
           return finite({p.x, p.y});
         });
}
bool finite(const Mover& mover);

template <class Row>
bool all_finite(const std::vector<Row>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const Row& row) { return finite(row); });
}

bool finite(const Mover& m) {
  return finite(m.X_WM) && finite({m.radius}) && all_finite(m.body) && all_finite(m.lasers) && all_finite(m.sensors) &&
         all_finite(m.magnets);
}

// Checks that the numbers behind readings are finite. World files are checked when they are read, but a recording's
// world is untrusted.
void check_numbers(const World& world) {
  const bool good = all_finite(world.walls) && all_finite(world.lane_markings) && all_finite(world.magnets) &&
                    all_finite(world.movers) && finite({world.road_resolution, world.magnet_cutoff, world.interval});
  if (!good) refuse("a number in it is infinite or NaN");
}

// Checks the rules of world.h for rows; users of a world do not check them again.
void check_rows(const World& world) {
  bool good = true;
  for (const Path& path : world.paths) {
    good &= !path.pieces.empty();
    for (const PathPiece& piece : path.pieces) good &= piece.length > 0.0 && piece.width > 0.0;
  }
  for (const Light& light : world.lights) {
    good &= !light.phases.empty() && std::isfinite(light.offset);
    for (const LightPhase& phase : light.phases) good &= phase.duration > 0.0 && std::isfinite(phase.duration);
  }
  for (const Emitter& e : world.emitters) good &= e.range > 0.0 && e.fov > 0.0 && e.halo >= 0.0;
  for (const FloorHole& hole : world.floor_holes) good &= hole.outline.size() >= 3;
  for (const Mover& m : world.movers) {
    good &= m.max_acceleration > 0.0 && m.max_turn_acceleration > 0.0 && m.track > 0.0;
    for (const Laser& l : m.lasers)
      good &= l.samples >= 1 && l.samples <= kMaxSamples && l.resolution >= 1 && l.rate > 0.0 && l.range_max > 0.0;
  }
  good &= world.interval > 0.0;
  if (!good) refuse("a row breaks the rules of its table");
}

void get_extras(base::ByteReader& in, World& world) {
  for (std::uint32_t left = get_count(in, 8); left > 0; --left) {
    const std::string type = in.get_string();
    world.unmodelled[type] = in.get<std::int32_t>();
  }
  get_rows(in, world.warnings, 12, [](base::ByteReader& bytes) {
    Warning warning;
    warning.file = bytes.get_string();
    warning.line = bytes.get<std::int32_t>();
    warning.message = bytes.get_string();
    return warning;
  });
}

}  // namespace

namespace {

/// Paths relative to the world file's folder: the spelling of the world file's path is not part of the world.
struct Spelling {
  std::filesystem::path folder;

  std::string operator()(const std::string& file) const {
    const auto path = std::filesystem::path(file).lexically_normal();
    const std::string own = path.lexically_relative(folder).string();
    return file.empty() || own.empty() ? file : own;
  }
  Mover operator()(Mover mover) const {
    for (Laser& laser : mover.lasers) laser.accuracy.file = (*this)(laser.accuracy.file);
    for (Sensor& sensor : mover.sensors) {
      sensor.file = (*this)(sensor.file);
      for (Setting& setting : sensor.settings) setting.file = (*this)(setting.file);
    }
    return mover;
  }
};

}  // namespace

std::vector<std::uint8_t> snapshot(const World& world) {
  const Spelling spelt{std::filesystem::path(world.file).parent_path().lexically_normal()};
  std::vector<std::uint8_t> bytes;
  base::ByteWriter out(bytes);
  out.put(kMagic);
  out.put(kVersion);
  out.put_string(world.name);
  out.put_string(spelt(world.file));
  out.put(world.road_resolution);
  out.put(world.magnet_cutoff);
  Accuracy accuracy = world.accuracy;
  accuracy.file = spelt(accuracy.file);
  put(out, accuracy, RowFields::all);
  out.put(world.interval);
  out.put(static_cast<std::uint32_t>(world.models.size()));
  for (const Model& model : world.models) put(out, model, RowFields::all);
  put_rows(out, world.walls);
  out.put(static_cast<std::uint32_t>(world.lane_markings.size()));
  for (const LaneMarking& marking : world.lane_markings) put(out, marking, RowFields::all);
  put_rows(out, world.magnets);
  out.put(static_cast<std::uint32_t>(world.movers.size()));
  for (const Mover& mover : world.movers) put(out, spelt(mover), RowFields::all);
  put_rows(out, world.paths);
  put_rows(out, world.lights);
  put_rows(out, world.emitters);
  put_rows(out, world.floor_holes);
  out.put(static_cast<std::uint32_t>(world.road_files.size()));
  for (const std::string& file : world.road_files) out.put_string(spelt(file));
  out.put(static_cast<std::uint32_t>(world.unmodelled.size()));
  for (const auto& [type, count] : world.unmodelled) {
    out.put_string(type);
    out.put(static_cast<std::int32_t>(count));
  }
  out.put(static_cast<std::uint32_t>(world.warnings.size()));
  for (const Warning& warning : world.warnings) {
    out.put_string(spelt(warning.file));
    out.put(static_cast<std::int32_t>(warning.line));
    out.put_string(warning.message);
  }
  out.put(world.hash);
  return bytes;
}

World from_snapshot(const std::vector<std::uint8_t>& bytes) {
  base::ByteReader in(bytes);
  if (in.get<std::uint32_t>() != kMagic) refuse("these bytes are no world");
  const auto version = in.get<std::uint16_t>();
  if (version != kVersion) refuse("version " + std::to_string(version) + "; expected " + std::to_string(kVersion));

  World world;
  world.name = in.get_string();
  world.file = in.get_string();
  world.road_resolution = in.get<double>();
  world.magnet_cutoff = in.get<double>();
  world.accuracy = get_accuracy(in);
  world.interval = in.get<double>();
  get_rows(in, world.models, 68, get_model);
  get_rows(in, world.walls, 53, get_segment);
  get_rows(in, world.lane_markings, kLaneMarkingBytes, get_lane_marking);
  get_rows(in, world.magnets, kMagnetBytes, get_magnet);
  get_rows(in, world.movers, kMoverBytes, get_mover);
  get_rows(in, world.paths, kPathBytes, get_path);
  get_rows(in, world.lights, kLightBytes, get_light);
  get_rows(in, world.emitters, kEmitterBytes, get_emitter);
  get_rows(in, world.floor_holes, kFloorHoleBytes, get_floor_hole);
  get_rows(in, world.road_files, 4, [](base::ByteReader& from) { return from.get_string(); });
  get_extras(in, world);
  const auto hash = in.get<std::uint64_t>();
  if (!in.good() || in.left() != 0) refuse("truncated, or longer than declared");
  check_links(world);
  check_rows(world);
  check_numbers(world);
  update_extent_and_hash(world);
  if (world.hash != hash) refuse("its content does not have the hash it was saved with");
  return world;
}

}  // namespace sf::world
