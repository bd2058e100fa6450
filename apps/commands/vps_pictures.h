#pragma once
// Camera images with tags, walls and readings drawn over them: the pictures of `vps --overlay`, and the live view of
// `vps --view`.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/commands/vps_readings.h"
#include "apps/options/options.h"
#include "bridges/image_view.h"
#include "vision/opencv.h"
#include "vision/overlay.h"
#include "vision/positioning.h"
#include "vision/testbed.h"

namespace sf::apps {

class VpsPictures {
 public:
  static constexpr std::uint64_t kMostPictures = 20'000;  ///< per camera, which limits disk usage

  /// Opens files and view. @param options, testbed must outlive this
  /// @throws base::InputError if one cannot be opened
  VpsPictures(const VpsOptions& options, const vision::Testbed& testbed);

  /// Draws image `number` of each camera where it is to be written or shown.
  /// @param time [ns] of the images since 1970
  void show(const vision::Positioning& positioning, std::span<const vision::TrackedTag> tags,
            std::span<const vision::Frame> frames, std::uint64_t number, std::int64_t time);
  /// Receives readings while there are no images: their socket must not fill up with old ones.
  void skip() {
    if (readings_) readings_->lines({});
  }

 private:
  using Lines = std::span<const vision::PlaneLine>;

  void refuse_inputs() const;
  void open_videos();
  bool is_due(std::uint64_t number);
  vision::Image drawn(std::size_t camera, const vision::Positioning& positioning,
                      std::span<const vision::TrackedTag> tags, const vision::Image& image, Lines lines) const;
  void write(std::size_t camera, const vision::Image& picture, std::uint64_t number);

  const VpsOptions& options_;
  const vision::Testbed& testbed_;
  std::uint64_t pictures_ = 0;  ///< written per camera
  std::vector<std::unique_ptr<vision::VideoFile>> videos_;
  std::optional<SeenReadings> readings_;
  std::vector<std::vector<vision::Mark>> world_marks_;  ///< per camera
  std::optional<bridges::ImageView> view_;
};

}  // namespace sf::apps
