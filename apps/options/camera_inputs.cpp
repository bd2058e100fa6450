#include "apps/options/camera_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <variant>

#include "apps/reports/text.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "base/suggest.h"
#include "base/thread_pool.h"
#include "netio/packets.h"
#include "vision/watched_source.h"

namespace sf::apps {

namespace {

class OpenedInputs : public CameraInputs {
 public:
  using Result = vision::WatchedSource::Result;
  OpenedInputs(const vision::Testbed& testbed, std::vector<std::unique_ptr<vision::ImageSource>> sources,
               std::chrono::milliseconds limit, const std::atomic<bool>& stop)
      : testbed_(testbed), limit_(limit), stop_(stop), rate_(testbed.cameras[0].camera.rate) {
    for (const auto& source : sources) live_ = live_ || source->is_live();
    if (sources[0]->rate() > 0.0) rate_ = sources[0]->rate();
    for (std::size_t i = 0; i < sources.size(); ++i) {
      Input input;
      if (sources[i]->is_live())
        input.watched =
            std::make_unique<vision::WatchedSource>(std::move(sources[i]), limit_of(testbed.cameras[i].camera), stop);
      else
        input.file = std::move(sources[i]);
      inputs_.push_back(std::move(input));
    }
  }

  bool next(std::vector<vision::Frame>& frames, std::span<const std::uint8_t> asleep) override {
    if (count_ == 0) start_ = now();
    frames.resize(inputs_.size());
    std::size_t ended = 0;
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      frames[i].unread = !asleep.empty() && asleep[i] != 0;
      if (frames[i].unread) frames[i].image.pixels.clear();
      const Result result = read(i, frames[i].image, frames[i].unread);
      if (result == Result::ended && (inputs_[i].file || ++ended == inputs_.size())) return false;
      frames[i].time = live_ ? now() - start_ : static_cast<double>(count_) / rate_;
      frames[i].missing = result != Result::image;
    }
    ++count_;
    return true;
  }
  bool is_live() const override { return live_; }

 private:
  struct Input {
    std::unique_ptr<vision::ImageSource> file;       ///< null: live
    std::unique_ptr<vision::WatchedSource> watched;  ///< null: a file
    Result last = Result::image;
  };

  Result read(std::size_t i, vision::Image& image, bool skipped) {
    Input& input = inputs_[i];
    if (input.file && skipped) return input.file->skip() ? Result::image : Result::ended;
    if (input.file) return input.file->next(image) ? Result::image : Result::ended;
    if (input.last == Result::ended) return Result::ended;
    const Result result = input.watched->next(image, skipped);
    if (result != input.last && !stop_) report(testbed_.cameras[i].camera, result);
    return input.last = result;
  }

  /// Slow cameras have three periods.
  std::chrono::milliseconds limit_of(const vision::Camera& camera) const {
    return std::max(limit_, std::chrono::milliseconds(static_cast<std::int64_t>(3e3 / camera.rate)));
  }

  void report(const vision::Camera& camera, Result result) const {
    if (result == Result::stalled)
      print_message("camera '{}' has sent no image for {:g} s; going on without it. Check the camera and its cable",
                    camera.name, 1e-3 * static_cast<double>(limit_of(camera).count()));
    else
      print_message("camera '{}' sends {}", camera.name, result == Result::image ? "images again" : "no more images");
  }

  static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  const vision::Testbed& testbed_;
  std::chrono::milliseconds limit_;
  const std::atomic<bool>& stop_;
  std::vector<Input> inputs_;
  double rate_;
  bool live_ = false;
  double start_ = 0.0;  ///< [s] time of the first call of `next`, which is time 0 of live images
  std::uint64_t count_ = 0;
};

/// Simulated cameras of a testbed.
class RenderedCameras {
 public:
  /// @throws base::InputError if the cameras have more than 64 Mpx in total
  RenderedCameras(const vision::Testbed& testbed, std::uint64_t seed) : testbed_(testbed) {
    check_size(testbed);
    for (const vision::TestbedCamera& each : testbed.cameras)
      renderers_.emplace_back(each.camera, vision::Imaging{}, seed);
  }

  /// Renders images whose exposure starts at `time` [s]. `scene_at` returns the scene in the middle of an exposure.
  template <class SceneAt>
  void render(const SceneAt& scene_at, double time, std::vector<vision::Frame>& frames) {
    frames.resize(renderers_.size());
    pool_.parallel_for(renderers_.size(), 1, [&](std::size_t first, std::size_t last, unsigned) {
      for (std::size_t i = first; i < last; ++i) {
        const vision::Camera& camera = testbed_.cameras[i].camera;
        const double middle = time + 0.5 * (camera.exposure + camera.readout);
        renderers_[i].render(scene_at(middle), time, count_, frames[i].image);
        frames[i].time = time;
      }
    });
    ++count_;
  }
  double rate() const { return testbed_.cameras[0].camera.rate; }
  std::uint32_t count() const { return count_; }

 private:
  static void check_size(const vision::Testbed& testbed) {
    std::int64_t pixels = 0;
    for (const vision::TestbedCamera& each : testbed.cameras)
      pixels += std::int64_t{each.camera.intrinsics.width} * each.camera.intrinsics.height;
    if (pixels > vision::kMaxImagePixels)
      throw base::InputError(testbed.file, 0,
                             fmt::format("'size' of all cameras is {} Mpx together; rendered images (--rendered, "
                                         "--robots) have at most {} Mpx",
                                         pixels >> 20, vision::kMaxImagePixels >> 20));
  }

  const vision::Testbed& testbed_;
  std::vector<vision::Renderer> renderers_;
  base::ThreadPool pool_;
  std::uint32_t count_ = 0;
};

class RenderedInputs : public CameraInputs {
 public:
  RenderedInputs(const vision::Testbed& testbed, const vision::RenderedFleet& fleet, std::uint64_t seed)
      : fleet_(fleet), cameras_(testbed, seed) {}

  bool next(std::vector<vision::Frame>& frames, std::span<const std::uint8_t>) override {
    cameras_.render([&](double time) { return fleet_.scene_at(time); }, cameras_.count() / cameras_.rate(), frames);
    return true;
  }

 private:
  const vision::RenderedFleet& fleet_;
  RenderedCameras cameras_;
};

class LiveRobotInputs : public RobotInputs {
 public:
  LiveRobotInputs(const vision::Testbed& testbed, const netio::Endpoint& listen, std::uint64_t seed,
                  const std::atomic<bool>& stop)
      : cameras_(testbed, seed), robots_(testbed), stop_(stop), socket_(netio::open_udp(listen)), batch_(64) {}

  bool next(std::vector<vision::Frame>& frames, std::span<const std::uint8_t>) override {
    if (cameras_.count() == 0) start_ = base::unix_time();
    due_ = std::max(due_, now());  // a late image delays the following ones, as in a slow camera
    for (double left = 0.0; (left = due_ - now()) > 0.0 && !stop_;) {
      receive();
      netio::wait_readable(socket_, socket_, static_cast<int>(std::ceil(std::min(1e3 * left, 100.0))));
    }
    receive();
    if (stop_) return false;
    const double time = now();
    due_ = time + 1.0 / cameras_.rate();
    cameras_.render([&](double middle) { return robots_.scene_at(middle); }, time, frames);
    return true;
  }
  bool is_live() const override { return true; }
  TruthCounts truth() const override { return {robots_.size(), accepted_, refused_}; }

 private:
  static constexpr std::size_t kMostDatagrams = 65'536;

  double now() const { return 1e-9 * static_cast<double>(base::unix_time() - start_); }
  void receive() {
    batch_.drain(socket_, kMostDatagrams, [&](std::span<const std::uint8_t> bytes, const netio::Endpoint&) {
      ++(take(bytes) ? accepted_ : refused_);
    });
  }
  bool take(std::span<const std::uint8_t> bytes) {
    netio::Packet packet;
    if (netio::decode(bytes, packet) != netio::PacketStatus::accepted) return false;
    const auto* state = std::get_if<netio::V2v>(&packet.body);
    if (state == nullptr) return false;
    const glm::dvec2 velocity = base::rotate(state->X_WR.yaw, {state->velocity.forward, state->velocity.left});
    return robots_.update(packet.header.robot, state->X_WR, velocity, state->velocity.turn,
                          1e-9 * static_cast<double>(packet.header.time - start_));
  }

  RenderedCameras cameras_;
  vision::RenderedRobots robots_;
  const std::atomic<bool>& stop_;
  netio::Socket socket_;
  netio::ReceiveBatch batch_;
  std::int64_t start_ = 0;  ///< [ns] Unix time of time 0
  double due_ = 0.0;        ///< [s] of the next image
  std::uint64_t accepted_ = 0, refused_ = 0;
};

}  // namespace

std::unique_ptr<CameraInputs> open_inputs(const vision::Testbed& testbed,
                                          const std::vector<std::pair<std::string, std::string>>& chosen,
                                          const std::atomic<bool>& stop) {
  std::vector<std::string_view> names;
  for (const vision::TestbedCamera& each : testbed.cameras) names.push_back(each.camera.name);
  for (const auto& [name, source] : chosen)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw base::InputError(
          fmt::format("--input: {} has no camera '{}'{}", testbed.file, name, base::expected_one_of(name, names)));
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
  return source_inputs(testbed, std::move(sources), std::chrono::seconds(2), stop);
}

std::unique_ptr<CameraInputs> source_inputs(const vision::Testbed& testbed,
                                            std::vector<std::unique_ptr<vision::ImageSource>> sources,
                                            std::chrono::milliseconds limit, const std::atomic<bool>& stop) {
  return std::make_unique<OpenedInputs>(testbed, std::move(sources), limit, stop);
}

std::unique_ptr<CameraInputs> rendered_inputs(const vision::Testbed& testbed, const vision::RenderedFleet& fleet,
                                              std::uint64_t seed) {
  return std::make_unique<RenderedInputs>(testbed, fleet, seed);
}

std::unique_ptr<RobotInputs> robot_inputs(const vision::Testbed& testbed, const netio::Endpoint& listen,
                                          std::uint64_t seed, const std::atomic<bool>& stop) {
  return std::make_unique<LiveRobotInputs>(testbed, listen, seed, stop);
}

}  // namespace sf::apps
