#include "world/serialization.h"

#include "base/error.h"

namespace sf::world {

using base::ByteReader;
using base::ByteWriter;

namespace {

constexpr std::size_t kPieceBytes = 56;
constexpr std::size_t kPhaseBytes = 9;

void put_vec(ByteWriter& out, glm::dvec2 p) {
  out.put(p.x);
  out.put(p.y);
}

glm::dvec2 get_vec(ByteReader& in) {
  const double x = in.get<double>();
  return {x, in.get<double>()};
}

}  // namespace

void put(ByteWriter& out, const Accuracy& accuracy, RowFields fields) {
  if (fields == RowFields::all || !accuracy.word.empty()) out.put_string(accuracy.word);
  if (fields == RowFields::physics) return;
  out.put(static_cast<std::int32_t>(accuracy.line));
  out.put_string(accuracy.file);
}

Accuracy get_accuracy(ByteReader& in) {
  Accuracy accuracy;
  accuracy.word = in.get_string();
  accuracy.line = in.get<std::int32_t>();
  accuracy.file = in.get_string();
  return accuracy;
}

void put(ByteWriter& out, const Pose& pose) {
  out.put(pose.x);
  out.put(pose.y);
  out.put(pose.z);
  out.put(pose.yaw);
}

Pose get_pose(ByteReader& in) {
  Pose pose;
  for (double* value : {&pose.x, &pose.y, &pose.z, &pose.yaw}) *value = in.get<double>();
  return pose;
}

void put(ByteWriter& out, const Segment& segment) {
  put_vec(out, segment.a);
  put_vec(out, segment.b);
  out.put(segment.z_min);
  out.put(segment.z_max);
  out.put(segment.model);
  const int flags = (segment.solid_left ? 1 : 0) | (segment.seen_by_laser ? 2 : 0) | (segment.stops_robots ? 4 : 0) |
                    (segment.seen_by_laneedge ? 8 : 0);
  out.put(static_cast<std::uint8_t>(flags));
}

Segment get_segment(ByteReader& in) {
  Segment segment;
  segment.a = get_vec(in);
  segment.b = get_vec(in);
  segment.z_min = in.get<double>();
  segment.z_max = in.get<double>();
  segment.model = in.get<std::uint32_t>();
  const auto flags = in.get<std::uint8_t>();
  segment.solid_left = (flags & 1) != 0;
  segment.seen_by_laser = (flags & 2) != 0;
  segment.stops_robots = (flags & 4) != 0;
  segment.seen_by_laneedge = (flags & 8) != 0;
  return segment;
}

void put(ByteWriter& out, const LaneMarking& marking, RowFields fields) {
  out.put(static_cast<std::uint32_t>(marking.line.size()));
  for (const glm::dvec2& p : marking.line) put_vec(out, p);
  out.put(marking.width);
  if (fields == RowFields::all) out.put(marking.color);
}

LaneMarking get_lane_marking(ByteReader& in) {
  LaneMarking marking;
  marking.line.resize(get_count(in, 2 * sizeof(double)));
  for (glm::dvec2& p : marking.line) p = get_vec(in);
  marking.width = in.get<double>();
  marking.color = in.get<std::uint32_t>();
  return marking;
}

void put(ByteWriter& out, const Magnet& magnet) {
  put_vec(out, magnet.p);
  for (const double value : {magnet.z, magnet.moment, magnet.radius}) out.put(value);
  out.put(magnet.model);
}

Magnet get_magnet(ByteReader& in) {
  Magnet magnet;
  magnet.p = get_vec(in);
  for (double* value : {&magnet.z, &magnet.moment, &magnet.radius}) *value = in.get<double>();
  magnet.model = in.get<std::uint32_t>();
  return magnet;
}

void put(ByteWriter& out, const Model& model, RowFields fields) {
  out.put_string(model.name);
  out.put_string(model.type);
  out.put(model.parent);
  out.put(model.mover);
  put(out, model.X_WM);
  put_vec(out, model.size);
  if (fields == RowFields::all) out.put(model.color);
  out.put(static_cast<std::uint8_t>(model.is_bitmap ? 1 : 0));
  out.put(model.pixel);
}

Model get_model(ByteReader& in) {
  Model model;
  model.name = in.get_string();
  model.type = in.get_string();
  model.parent = in.get<std::uint32_t>();
  model.mover = in.get<std::uint32_t>();
  model.X_WM = get_pose(in);
  model.size = get_vec(in);
  model.color = in.get<std::uint32_t>();
  model.is_bitmap = in.get<std::uint8_t>() != 0;
  model.pixel = in.get<double>();
  return model;
}

void put(ByteWriter& out, const Path& path) {
  out.put_string(path.name);
  out.put(static_cast<std::uint32_t>(path.pieces.size()));
  for (const PathPiece& piece : path.pieces) {
    put(out, piece.X_WP);
    for (const double value : {piece.length, piece.curvature, piece.width}) out.put(value);
  }
}

Path get_path(ByteReader& in) {
  Path path;
  path.name = in.get_string();
  path.pieces.resize(get_count(in, kPieceBytes));
  for (PathPiece& piece : path.pieces) {
    piece.X_WP = get_pose(in);
    for (double* value : {&piece.length, &piece.curvature, &piece.width}) *value = in.get<double>();
  }
  return path;
}

void put(ByteWriter& out, const Light& light) {
  out.put_string(light.name);
  out.put(light.model);
  put(out, light.X_WL);
  out.put(static_cast<std::uint8_t>(light.single ? 1 : 0));
  out.put(light.offset);
  out.put(static_cast<std::uint32_t>(light.phases.size()));
  for (const LightPhase& phase : light.phases) {
    out.put(static_cast<std::uint8_t>(phase.state));
    out.put(phase.duration);
  }
  out.put(static_cast<std::uint32_t>(light.points.size()));
  for (const std::string& point : light.points) out.put_string(point);
}

Light get_light(ByteReader& in) {
  Light light;
  light.name = in.get_string();
  light.model = in.get<std::uint32_t>();
  light.X_WL = get_pose(in);
  light.single = in.get<std::uint8_t>() != 0;
  light.offset = in.get<double>();
  light.phases.resize(get_count(in, kPhaseBytes));
  for (LightPhase& phase : light.phases) {
    phase.state = get_enum(in, LightState::flashing_yellow, "state of a light");
    phase.duration = in.get<double>();
  }
  light.points.resize(get_count(in, sizeof(std::uint32_t)));
  for (std::string& point : light.points) point = in.get_string();
  return light;
}

void put(ByteWriter& out, const Emitter& emitter) {
  out.put(static_cast<std::uint8_t>(emitter.kind));
  out.put(emitter.model);
  put(out, emitter.X_WE);
  for (const double value : {emitter.range, emitter.fov, emitter.halo}) out.put(value);
}

Emitter get_emitter(ByteReader& in) {
  Emitter emitter;
  emitter.kind = get_enum(in, Emitter::Kind::dock, "emitter");
  emitter.model = in.get<std::uint32_t>();
  emitter.X_WE = get_pose(in);
  for (double* value : {&emitter.range, &emitter.fov, &emitter.halo}) *value = in.get<double>();
  return emitter;
}

void put(ByteWriter& out, const FloorHole& hole) {
  out.put(hole.model);
  out.put(static_cast<std::uint32_t>(hole.outline.size()));
  for (const glm::dvec2& p : hole.outline) put_vec(out, p);
}

FloorHole get_floor_hole(ByteReader& in) {
  FloorHole hole;
  hole.model = in.get<std::uint32_t>();
  hole.outline.resize(get_count(in, 2 * sizeof(double)));
  for (glm::dvec2& p : hole.outline) p = get_vec(in);
  return hole;
}

std::uint32_t get_count(ByteReader& in, std::size_t row_size) {
  const auto count = in.get<std::uint32_t>();
  if (!in.good() || count > in.left() / row_size) throw base::InputError("broken world snapshot: cut short");
  return count;
}

}  // namespace sf::world
