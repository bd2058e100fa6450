#include "server/received_camera.h"

#include <algorithm>

#include "base/error.h"
#include "sensors/image_packets.h"
#include "world/picture.h"

namespace sf::server {

namespace {

const std::string kImageName = "image of a camera";  // in errors

/// Writes the colours of a picture of the camera's size into its reading.
class ColorSink final : public world::PictureSink {
 public:
  ColorSink(const sensors::CameraSettings& camera, std::vector<double>& values)
      : PictureSink(kImageName, std::max(camera.width, camera.height)), camera_(camera), values_(values) {}

  void start() override {
    if (width() != camera_.width || height() != camera_.height) throw base::InputError(file(), 0, "another size");
  }
  void add(const world::PixelRow& row) override {
    for (std::size_t i = 0; i < row.rgba.size(); i += 4, next_ += camera_.columns())
      values_[next_] = row.rgba[i] << 16 | row.rgba[i + 1] << 8 | row.rgba[i + 2];
  }

 private:
  const sensors::CameraSettings& camera_;
  std::vector<double>& values_;
  std::size_t next_ = 1;  ///< place of the next pixel's colour
};

/// Packets have these formats only; GIF would be read from a file.
bool is_png_or_jpeg(std::string_view file) { return file.starts_with("\x89PNG") || file.starts_with("\xFF\xD8"); }

/// @return false if the file, which may be any bytes, is no image of the camera
bool decode_colors(const std::string& file, const sensors::CameraSettings& camera, std::vector<double>& values) {
  if (!is_png_or_jpeg(file)) return false;
  try {
    ColorSink sink(camera, values);
    world::decode_picture(file, sink);
  } catch (const base::InputError&) {
    return false;
  }
  return true;
}

}  // namespace

void ReceivedCamera::begin_image(std::uint32_t sequence, std::uint32_t bytes, std::uint32_t parts) {
  any_image_ = true, image_ = sequence;
  file_.assign(bytes, '\0');
  seen_.assign(parts, false);
  missing_ = parts;
}

void ReceivedCamera::take_part(std::uint32_t sequence, std::span<const std::uint8_t> payload) {
  sensors::ImagePart part;
  if (sensors::read_image(payload, part) != sensors::PayloadError::none) return;
  const auto ahead = static_cast<std::int32_t>(sequence - image_);
  const auto dropout = static_cast<std::int32_t>(netio::ReadingAssembler::kMaxDropout);
  if (any_image_ && ahead < 0 && ahead >= -dropout) return;  // older; further behind, the sender has restarted
  if (!any_image_ || ahead != 0) begin_image(sequence, part.total, part.parts);
  if (part.total != file_.size() || seen_[part.part]) return;
  seen_[part.part] = true;
  std::ranges::copy(part.bytes, file_.begin() + part.first);
  if (--missing_ == 0) combine();
}

void ReceivedCamera::take_depths(const netio::CompleteReading& reading) {
  depth_values_.assign(reading.values.begin(), reading.values.end());
  depths_ = reading;
  combine();
}

/// Makes the newest reading of depths and image, if these belong together.
void ReceivedCamera::combine() {
  if (!depths_ || !any_image_ || missing_ > 0 || image_ != depths_->sequence) return;
  std::vector<double> values = depth_values_;
  if (!decode_colors(file_, settings_, values)) return void(++counts_.invalid);
  values_ = std::move(values);
  whole_ = depths_;
  ++counts_.whole;
}

std::optional<netio::CompleteReading> ReceivedCamera::newest() const {
  if (!whole_) return std::nullopt;
  netio::CompleteReading reading = *whole_;
  reading.values = values_;
  return reading;
}

void ReceivedCamera::restart() {
  any_image_ = false;
  depths_.reset(), whole_.reset();
}

}  // namespace sf::server
