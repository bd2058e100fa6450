#include "record/shapes_message.h"

#include "record/cdr.h"
#include "record/ros_messages.h"

namespace sf::record {

namespace {

constexpr std::size_t kLeastShape = 72;  // [byte]

}  // namespace

void encode_shapes(std::int64_t time, std::span<const base::ShapeState> shapes, base::Bytes& out) {
  CdrWriter cdr(out);
  put_header(cdr, time, "world");
  cdr.put_count(shapes.size());
  for (const base::ShapeState& shape : shapes) {
    cdr.put(shape.mover);
    cdr.put(shape.shape);
    cdr.put(shape.color);
    for (const double number :
         {shape.size.x, shape.size.y, shape.size.z, shape.X_MB.x, shape.X_MB.y, shape.X_MB.z, shape.X_MB.yaw})
      cdr.put(number);
  }
}

bool decode_shapes(std::span<const std::uint8_t> message, ShapesSample& sample) {
  CdrReader cdr(message);
  get_header(cdr, sample.time);
  sample.shapes.clear();
  for (std::uint32_t left = cdr.get_count(kLeastShape - 4); left > 0 && cdr.good(); --left) {
    base::ShapeState& shape = sample.shapes.emplace_back();
    shape.mover = cdr.get<std::uint32_t>();
    shape.shape = cdr.get<std::uint32_t>();
    shape.color = cdr.get<std::uint32_t>();
    for (double* const number :
         {&shape.size.x, &shape.size.y, &shape.size.z, &shape.X_MB.x, &shape.X_MB.y, &shape.X_MB.z, &shape.X_MB.yaw})
      *number = cdr.get<double>();
  }
  return cdr.good();
}

}  // namespace sf::record
