#include "apps/commands/vps_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "apps/commands/numbered_files.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "viz/png.h"

namespace sf::apps {

namespace {

constexpr int kMostSide = 1280;  // [px] of images in the view

std::vector<bridges::SeenTag> seen_tags(std::span<const vision::TrackedTag> tags) {
  std::vector<bridges::SeenTag> seen;
  for (const vision::TrackedTag& tag : tags) {
    const glm::dvec2 own = base::rotate(-tag.X_WT.yaw, tag.velocity);
    seen.push_back({tag.id, tag.X_WT, {own.x, own.y, tag.turn}, static_cast<std::uint32_t>(tag.cameras)});
  }
  return seen;
}

}  // namespace

VpsPictures::VpsPictures(const VpsOptions& options, const vision::Testbed& testbed)
    : options_(options), testbed_(testbed) {
  if (!options.overlay.empty()) {
    refuse_inputs();
    const std::string extension = std::filesystem::path(options.overlay).extension();
    std::error_code ignored;
    const bool is_folder = extension.empty() || std::filesystem::is_directory(options.overlay, ignored);
    if (!is_folder && extension != ".avi")
      throw base::InputError(
          fmt::format("--overlay {}: expected a folder or a video (*.avi); a folder with '{}' in its name must exist",
                      options.overlay, extension));
    if (!is_folder)
      open_videos();
    else
      for (const vision::TestbedCamera& each : testbed.cameras)
        begin_numbered_files(options.overlay, each.camera.name + "-", ".png");
  }
  if (options.readings > 0)
    readings_.emplace(options.world, netio::Endpoint{netio::resolve(options.bind), options.readings}, testbed);
  if (!options.world.empty()) {
    const world::World world = readings_ ? readings_->world() : world::load_world(options.world);
    for (const vision::TestbedCamera& each : testbed.cameras)
      world_marks_.push_back(vision::world_marks(each.camera, world));
  }
  if (!options.view) return;
  std::vector<std::string> names;
  for (const vision::TestbedCamera& each : testbed.cameras) names.push_back(each.camera.name);
  view_.emplace("sensorfarm: " + std::filesystem::path(testbed.file).filename().string(), names,
                bridges::ImageViewOptions{*options.view});
  print_message("{}", view_->describe());
}

/// Refuses to write pictures into the folders of the input images.
void VpsPictures::refuse_inputs() const {
  auto sources = options_.inputs;
  if (sources.empty())
    for (const vision::TestbedCamera& each : testbed_.cameras) sources.emplace_back(each.camera.name, each.source);
  for (const auto& [camera, source] : sources)
    if (std::error_code ignored; std::filesystem::equivalent(source, options_.overlay, ignored))
      throw base::InputError(options_.overlay, 0,
                             "contains the images of camera '" + camera + "'; name another --overlay");
}

/// Opens one video per camera: tags.avi, or with several cameras tags-north.avi and so on.
void VpsPictures::open_videos() {
  const std::string& path = options_.overlay;
  const std::string stem = path.substr(0, path.size() - 4);
  for (const vision::TestbedCamera& each : testbed_.cameras) {
    const std::string file = testbed_.cameras.size() == 1 ? path : fmt::format("{}-{}.avi", stem, each.camera.name);
    const vision::Intrinsics& i = each.camera.intrinsics;
    videos_.push_back(
        vision::opencv().open_video(file, i.width, i.height, std::max(1.0, each.camera.rate / options_.every)));
  }
}

/// Returns whether image `number` is to be written.
bool VpsPictures::is_due(std::uint64_t number) {
  if (options_.overlay.empty() || number % options_.every != 0 || pictures_ > kMostPictures) return false;
  if (pictures_++ < kMostPictures) return true;
  print_message("--overlay ends after {} pictures per camera; draw fewer with --every N", kMostPictures);
  return false;
}

void VpsPictures::show(const vision::Positioning& positioning, std::span<const vision::TrackedTag> tags,
                       std::span<const vision::Frame> frames, std::uint64_t number, std::int64_t time) {
  const bool written = is_due(number);
  const auto wanted = view_ ? view_->wanted() : std::nullopt;
  // Readings are received even if nothing is drawn: their socket must not fill up with old ones.
  const Lines lines = readings_ ? readings_->lines(tags) : Lines{};
  std::vector<bridges::CameraPicture> pictures;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool shown = wanted && std::find(wanted->begin(), wanted->end(), i) != wanted->end();
    if (frames[i].image.pixels.empty() || !(written || shown)) continue;
    const vision::Image picture = drawn(i, positioning, tags, frames[i].image, lines);
    if (written) write(i, picture, number);
    if (shown) pictures.push_back({i, vision::opencv().encode_jpeg(picture, kMostSide)});
  }
  if (wanted) view_->publish(time, std::move(pictures), seen_tags(tags));
}

vision::Image VpsPictures::drawn(std::size_t i, const vision::Positioning& positioning,
                                 std::span<const vision::TrackedTag> tags, const vision::Image& image,
                                 Lines lines) const {
  const vision::Camera& camera = testbed_.cameras[i].camera;
  std::vector<vision::Mark> marks = world_marks_.empty() ? std::vector<vision::Mark>() : world_marks_[i];
  for (const auto& more :
       {vision::line_marks(camera, lines), vision::tag_marks(camera, positioning.sightings(i), tags)})
    marks.insert(marks.end(), more.begin(), more.end());
  return vision::draw_over(image, marks);
}

void VpsPictures::write(std::size_t i, const vision::Image& picture, std::uint64_t number) {
  if (!videos_.empty()) return videos_[i]->write(picture);
  viz::write_png(fmt::format("{}/{}-{:06}.png", options_.overlay, testbed_.cameras[i].camera.name, number),
                 picture.pixels, picture.width, picture.height, base::PngContent::photograph);
}

}  // namespace sf::apps
