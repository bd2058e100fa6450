#include "apps/options/camera_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <variant>

#include "base/elapsed.h"
#include "base/error.h"
#include "base/suggest.h"
#include "base/thread_pool.h"
#include "netio/packets.h"

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

  bool next(std::vector<vision::Frame>& frames) override {
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

  bool next(std::vector<vision::Frame>& frames) override {
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
                                          const std::vector<std::pair<std::string, std::string>>& chosen) {
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
  return std::make_unique<OpenedInputs>(std::move(sources), testbed.cameras[0].camera.rate);
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
