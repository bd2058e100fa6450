#include "apps/camera_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "base/suggest.h"
#include "base/thread_pool.h"

namespace sf::apps {

namespace {

class OpenedInputs : public CameraInputs {
 public:
  explicit OpenedInputs(std::vector<std::unique_ptr<vision::ImageSource>> sources, double rate)
      : sources_(std::move(sources)), rate_(rate) {
    for (const auto& source : sources_) live_ = live_ || source->is_live();
    if (sources_[0]->rate() > 0.0) rate_ = sources_[0]->rate();
  }

  bool next(std::vector<vision::Frame>& frames) override {
    if (count_ == 0) start_ = now();
    frames.resize(sources_.size());
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      if (!sources_[i]->next(frames[i].image)) return false;
      frames[i].time = live_ ? now() - start_ : static_cast<double>(count_) / rate_;
    }
    ++count_;
    return true;
  }
  bool is_live() const override { return live_; }

 private:
  static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  std::vector<std::unique_ptr<vision::ImageSource>> sources_;
  double rate_ = 15.0;
  bool live_ = false;
  double start_ = 0.0;  ///< [s] time of the first call of `next`, which is time 0 of live images
  std::uint64_t count_ = 0;
};

class RenderedInputs : public CameraInputs {
 public:
  RenderedInputs(const vision::Testbed& testbed, const vision::RenderedFleet& fleet, std::uint64_t seed)
      : testbed_(testbed), fleet_(fleet) {
    for (const vision::TestbedCamera& each : testbed.cameras)
      renderers_.emplace_back(each.camera, vision::Imaging{}, seed);
  }

  bool next(std::vector<vision::Frame>& frames) override {
    frames.resize(renderers_.size());
    const double time = count_ / testbed_.cameras[0].camera.rate;
    pool_.parallel_for(renderers_.size(), 1, [&](std::size_t first, std::size_t last, unsigned) {
      for (std::size_t i = first; i < last; ++i) {
        const vision::Camera& camera = testbed_.cameras[i].camera;
        const double middle = time + 0.5 * (camera.exposure + camera.readout);
        renderers_[i].render(fleet_.scene_at(middle), time, count_, frames[i].image);
        frames[i].time = time;
      }
    });
    ++count_;
    return true;
  }

 private:
  const vision::Testbed& testbed_;
  const vision::RenderedFleet& fleet_;
  std::vector<vision::Renderer> renderers_;
  base::ThreadPool pool_;
  std::uint32_t count_ = 0;
};

}  // namespace

std::unique_ptr<CameraInputs> open_inputs(const vision::Testbed& testbed,
                                          const std::vector<std::pair<std::string, std::string>>& chosen) {
  std::vector<std::string_view> names;
  for (const vision::TestbedCamera& each : testbed.cameras) names.push_back(each.camera.name);
  for (const auto& [name, source] : chosen)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw base::InputError(fmt::format("--input: {} has no camera '{}'{}; expected one of: {}", testbed.file, name,
                                         base::suggest(name, names), fmt::join(names, ", ")));
  std::vector<std::unique_ptr<vision::ImageSource>> sources;
  for (const vision::TestbedCamera& each : testbed.cameras) {
    std::string source = each.source;
    for (const auto& [name, other] : chosen)
      if (name == each.camera.name) source = other;
    if (source.empty())
      throw base::InputError(testbed.file, 0,
                             fmt::format("camera '{0}' has no source; expected source = \"/dev/video0\" in the file, "
                                         "--input {0}=/dev/video0, or --rendered 30",
                                         each.camera.name));
    const vision::Intrinsics& i = each.camera.intrinsics;
    sources.push_back(vision::opencv().open_source(source, i.width, i.height, each.camera.rate));
  }
  return std::make_unique<OpenedInputs>(std::move(sources), testbed.cameras[0].camera.rate);
}

std::unique_ptr<CameraInputs> rendered_inputs(const vision::Testbed& testbed, const vision::RenderedFleet& fleet,
                                              std::uint64_t seed) {
  std::int64_t pixels = 0;
  for (const vision::TestbedCamera& each : testbed.cameras)
    pixels += std::int64_t{each.camera.intrinsics.width} * each.camera.intrinsics.height;
  if (pixels > vision::kMaxImagePixels)
    throw base::InputError(testbed.file, 0,
                           fmt::format("'size' of all cameras is {} Mpx together; --rendered expects at most {} Mpx",
                                       pixels >> 20, vision::kMaxImagePixels >> 20));
  return std::make_unique<RenderedInputs>(testbed, fleet, seed);
}

}  // namespace sf::apps
