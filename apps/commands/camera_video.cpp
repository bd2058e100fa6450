#include "apps/commands/camera_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/text.h"
#include "base/camera_pixels.h"
#include "base/error.h"
#include "base/time.h"
#include "scenarios/recorded_states.h"
#include "sensors/camera.h"
#include "sensors/sensor_set.h"

namespace sf::apps {

namespace {

struct Camera {
  const sensors::SensorSpec& row;
  const sensors::CameraSettings& settings;
};

/// @param name "ROBOT", of its first camera, or "ROBOT:CAMERA"
Camera find_camera(const world::World& world, const sensors::SensorSet& sensor_set, const std::string& name) {
  const auto settings = sensor_set.settings_of<sensors::CameraSettings>(sensors::kCamera);
  std::string known;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const sensors::SensorSpec& row = sensor_set.group(sensors::kCamera)->rows[i];
    const std::string& robot = world.movers[row.mover].name;
    const std::string full = robot + ":" + row.name;
    if (name == robot || name == full) return {row, settings[i]};
    if (i < 8) known += fmt::format("{}'{}'", known.empty() ? "" : ", ", full);
  }
  throw base::InputError(world.file, 0,
                         known.empty() ? fmt::format("has no camera '{}', nor any other", name)
                                       : fmt::format("has no camera '{}'; expected {} or the like", name, known));
}

/// The nearer, the brighter; black where nothing is seen.
std::uint8_t shade_of(double depth, double range_max) {
  const bool seen = depth < range_max;
  return static_cast<std::uint8_t>(seen ? 240.0 - 200.0 * std::sqrt(std::max(0.0, depth) / range_max) : 0.0);
}

std::vector<std::uint8_t> pixels_of(const sensors::CameraSettings& camera, std::span<const double> values) {
  if (camera.rgb) return base::color_bytes(values, camera.columns());
  std::vector<std::uint8_t> pixels;
  for (std::size_t i = 0; i < values.size(); i += camera.columns())
    pixels.insert(pixels.end(), 3, shade_of(values[i], camera.range_max));
  return pixels;
}

/// Videos have an even number of rows and columns, so the last ones of odd images are repeated.
viz::PixelImage frame_of(const sensors::CameraSettings& camera, std::span<const double> values) {
  const std::size_t width = camera.width, height = camera.height, wide = width + width % 2, high = height + height % 2;
  const std::vector<std::uint8_t> pixels = pixels_of(camera, values);
  viz::PixelImage image{static_cast<int>(wide), static_cast<int>(high), {}};
  for (std::size_t y = 0; y < high; ++y)
    for (std::size_t x = 0; x < wide; ++x) {
      const std::size_t at = 3 * (std::min(y, height - 1) * width + std::min(x, width - 1));
      image.rgb.insert(image.rgb.end(), {pixels[at], pixels[at + 1], pixels[at + 2]});
    }
  return image;
}

std::vector<const record::ReadingSample*> images_of(const RecordingPart& part, const Camera& camera,
                                                    const std::string& name) {
  std::vector<const record::ReadingSample*> images;
  for (const record::ReadingSample& reading : part.recording.readings)
    if (reading.type == sensors::kCamera && reading.mover == camera.row.mover && reading.sensor == camera.row.sensor &&
        reading.values.size() == std::size_t{camera.row.elements} * camera.settings.columns())
      images.push_back(&reading);
  if (images.empty())
    throw base::InputError(part.recording.file, 0,
                           fmt::format("has no images of the camera '{}' in this part; expected a recording of `run "
                                       "--record DIR --record-readings` with its robot",
                                       name));
  std::ranges::stable_sort(images, {}, [](const record::ReadingSample* image) { return image->time; });
  return images;
}

}  // namespace

void write_camera_video(const RecordingPart& part, const VideoOptions& options) {
  const world::World world = scenarios::recorded_world(part.recording);
  const sensors::SensorSet sensor_set(world);
  const Camera camera = find_camera(world, sensor_set, options.video_camera);
  const auto images = images_of(part, camera, options.video_camera);
  FrameSink sink(options, static_cast<int>(camera.settings.width + camera.settings.width % 2),
                 static_cast<int>(camera.settings.height + camera.settings.height % 2));
  const std::int64_t end = images.back()->time + base::nanoseconds(1.0 / camera.row.rate);
  std::optional<Progress> progress(options.frames.empty() ? "encoding" : "writing");
  std::size_t shown = images.size(), next = 0;
  viz::PixelImage frame;
  for (std::uint64_t k = 0; k == 0 || !stop_requested(); ++k) {
    const std::int64_t time =
        images[0]->time + base::nanoseconds(static_cast<double>(k) * options.video_speed / options.video_fps);
    if (time >= end) break;
    while (next + 1 < images.size() && images[next + 1]->time <= time) ++next;
    if (shown != next) frame = frame_of(camera.settings, images[next]->values);
    shown = next;
    sink.add(frame);
    progress->show(static_cast<double>(next) / static_cast<double>(images.size()));
  }
  progress.reset();
  const VideoFacts facts = sink.finish();
  print_message("wrote {}: {}", facts.file, video_text(facts));
  heed_stop(options.frames.empty() ? "interrupted: the video ends early but can be played"
                                   : "interrupted: the frames end early");
}

}  // namespace sf::apps
