#include "record/world_messages.h"

#include "record/cdr.h"
#include "record/ros_messages.h"

namespace sf::record {

namespace {

struct Marker {
  std::string_view frame;
  std::string_view group;  ///< `ns`: viewers show and hide groups
  std::int32_t id = 0;
  bool locked = false;  ///< moves with its frame
};

void put_color(CdrWriter& cdr, std::uint32_t argb) {
  for (const unsigned shift : {16u, 8u, 0u, 24u}) cdr.put(static_cast<float>((argb >> shift) & 0xFFu) / 255.0F);
}

/// Writes an empty sensor_msgs/CompressedImage, sequence of texture coordinates, text and mesh.
void put_no_texture(CdrWriter& cdr) {
  cdr.put("");
  put_header(cdr, 0, "");
  cdr.put("");
  cdr.put_count(0);
  cdr.put_count(0);
  cdr.put("");
  cdr.put("");
  cdr.put("");
  cdr.put_count(0);
  cdr.put(false);
}

void put_lines(CdrWriter& cdr, const Marker& marker, const Outline& outline) {
  constexpr std::int32_t kLineList = 5, kAdd = 0;
  constexpr double kWidth = 0.02;  // [m]
  put_header(cdr, 0, marker.frame);
  cdr.put(marker.group);
  cdr.put(marker.id);
  cdr.put(kLineList);
  cdr.put(kAdd);
  put_pose(cdr, {});
  for (const double scale : {kWidth, 0.0, 0.0}) cdr.put(scale);
  put_color(cdr, outline.color);
  cdr.put(std::int32_t{0});  // lifetime: unlimited
  cdr.put(std::uint32_t{0});
  cdr.put(marker.locked);
  cdr.put_count(outline.ends.size());
  for (const glm::dvec3& end : outline.ends)
    for (const double value : {end.x, end.y, end.z}) cdr.put(value);
  cdr.put_count(0);  // colours of single points
  put_no_texture(cdr);
}

}  // namespace

void encode_map(const WorldShape& shape, std::string_view frame, base::Bytes& out) {
  CdrWriter cdr(out);
  put_header(cdr, 0, frame);
  cdr.put(std::int32_t{0});
  cdr.put(std::uint32_t{0});
  cdr.put(static_cast<float>(shape.cell));
  cdr.put(shape.columns);
  cdr.put(shape.rows);
  put_pose(cdr, {shape.corner.x, shape.corner.y, 0.0, 0.0});
  cdr.put_count(shape.occupied.size());
  for (const bool occupied : shape.occupied) cdr.put(static_cast<std::int8_t>(occupied ? 100 : 0));
}

void encode_walls(const WorldShape& shape, base::Bytes& out) {
  CdrWriter cdr(out);
  cdr.put_count(shape.walls.size());
  std::int32_t id = 0;
  for (const Outline& wall : shape.walls) put_lines(cdr, {"world", "walls", id++, false}, wall);
}

void encode_bodies(std::span<const MoverInfo> movers, base::Bytes& out) {
  CdrWriter cdr(out);
  std::size_t count = 0;
  for (const MoverInfo& mover : movers) count += mover.body.size();
  cdr.put_count(count);
  std::int32_t id = 0;
  for (const MoverInfo& mover : movers)
    for (const Outline& part : mover.body) put_lines(cdr, {mover.base_frame, "bodies", id++, true}, part);
}

}  // namespace sf::record
