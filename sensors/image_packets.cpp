#include "sensors/image_packets.h"

#include <algorithm>

#include "base/camera_pixels.h"
#include "base/error.h"
#include "sensors/camera.h"
#include "sensors/laser_packets.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kFormAt = 14;
static_assert(kImagePartBytes == kPartBytes - kPartHeaderBytes);
static_assert(image_parts(kMostImageBytes) <= 65535);

std::uint32_t count_of(std::uint32_t total, std::uint32_t part) {
  return std::min(kImagePartBytes, total - part * kImagePartBytes);
}

}  // namespace

ImageFile image_file(const SensorSet& sensor_set, const base::ReadingBlock& reading) {
  if (reading.type != kCamera) return {};
  const CameraSettings& camera = sensor_set.settings_of<CameraSettings>(kCamera, reading.mover)[reading.sensor];
  if (!camera.rgb) return {};
  return {base::color_file(reading.values, camera.columns(), camera.format()), camera.jpeg > 0 ? kJpegForm : kPngForm};
}

std::uint8_t encode_image(const ImageFile& file, std::uint32_t part, base::Bytes& out) {
  SF_CHECK(file.bytes.size() <= kMostImageBytes && part < image_parts(file.bytes.size()),
           "part " + std::to_string(part) + " of " + std::to_string(file.bytes.size()) + " bytes");
  const auto total = static_cast<std::uint32_t>(file.bytes.size()), count = count_of(total, part);
  base::ByteWriter writer(out);
  writer.put(total);
  writer.put(part * kImagePartBytes);
  writer.put(static_cast<std::uint16_t>(part));
  writer.put(static_cast<std::uint16_t>(image_parts(total)));
  writer.put(static_cast<std::uint16_t>(count));
  writer.put(file.form);
  writer.put_bytes(file.bytes.data() + part * kImagePartBytes, count);
  return kCamera + kExtended;
}

std::uint16_t camera_form(std::uint8_t type, std::span<const std::uint8_t> payload) {
  const bool has_form = type == kCamera + kExtended && payload.size() >= kPartHeaderBytes;
  return has_form ? base::ByteReader(payload.subspan(kFormAt)).get<std::uint16_t>() : std::uint16_t{0};
}

PayloadError read_image(std::span<const std::uint8_t> payload, ImagePart& part) {
  base::ByteReader in(payload);
  part.total = in.get<std::uint32_t>(), part.first = in.get<std::uint32_t>();
  part.part = in.get<std::uint16_t>(), part.parts = in.get<std::uint16_t>();
  const std::size_t size = kPartHeaderBytes + in.get<std::uint16_t>();
  if (payload.size() != size) return payload.size() < size ? PayloadError::too_short : PayloadError::too_long;
  part.form = in.get<std::uint16_t>();
  part.bytes = payload.subspan(kPartHeaderBytes);
  const bool whole = part.total >= 1 && part.total <= kMostImageBytes && part.parts == image_parts(part.total) &&
                     part.part < part.parts && part.first == part.part * kImagePartBytes &&
                     part.bytes.size() == count_of(part.total, part.part);
  return whole ? PayloadError::none : PayloadError::out_of_range;
}

}  // namespace sf::sensors
