#include "scenarios/follow_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <deque>
#include <numeric>

#include "base/elementary.h"
#include "base/random.h"
#include "vision/positioning.h"
#include "vision/rendering/renderer.h"
#include "vision/tag_family.h"
#include "vision/testbed_patches.h"

namespace sf::scenarios {

namespace {

using vision::Patch;
using vision::TrueTag;

constexpr double kFollowSpacing = 2.0;                                       // [m] between cameras
constexpr double kFollowStart = -0.95;                                       // [m] x of the tag that crosses
constexpr double kFollowEnd = kFollowSpacing * (kFollowCameras - 1) + 0.95;  // [m]
constexpr double kBoardHeight = 1.0;                                         // [m]

double cpu_now() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Returns the true state of a tag: number 1 drives through all fields of view, in a slight weave; the others circle
/// above and below its way, two in each field of view.
TrueTag truth_of(std::uint32_t id, const FollowCase& setup, double time) {
  if (id == kFollowedTag) {
    constexpr double kWeave = 0.05, kWave = 2.0;  // [m], [rad/m]
    const double x = kFollowStart + setup.speed * time, slope = kWeave * kWave * base::cos(kWave * x);
    const double yaw = base::atan(slope), bend = -kWeave * kWave * kWave * base::sin(kWave * x);
    return {id,
            {x, kWeave * base::sin(kWave * x), 0.2, yaw},
            {setup.speed, setup.speed * slope},
            setup.speed * bend / (1.0 + slope * slope)};
  }
  const std::uint32_t place = id - 2;
  const double side = place % 2 == 0 ? 1.0 : -1.0, turn = 0.5 * side * (1.0 + 0.2 * place);
  const double angle = turn * time + place, radius = 0.1;
  const glm::dvec2 center{kFollowSpacing * (place / 2), 0.5 * side};
  return {id,
          {center.x + radius * base::cos(angle), center.y + radius * base::sin(angle), 0.2, base::wrap_angle(angle)},
          radius * turn * glm::dvec2{-base::sin(angle), base::cos(angle)},
          turn};
}

/// The images of all cameras.
class FollowStage {
 public:
  FollowStage(const vision::Testbed& testbed, const FollowCase& setup, std::uint64_t seed)
      : testbed_(testbed), setup_(setup), clutter_(vision::clutter(testbed, seed)) {
    for (const auto& each : testbed.cameras) renderers_.emplace_back(each.camera, vision::Imaging{}, seed);
    for (std::uint32_t id = 1; id <= kFollowTags; ++id)
      patterns_.push_back(vision::family_pattern(testbed.dictionary, id));
    frames_.resize(renderers_.size());
  }

  std::span<const vision::Frame> images(double time) {
    const vision::Camera& camera = testbed_.cameras[0].camera;
    const double middle = time + 0.5 * (camera.exposure + camera.readout);
    vision::Scene scene;
    scene.gradient = {0.06, -0.04};
    scene.patches = clutter_;
    for (std::uint32_t id = 1; id <= kFollowTags; ++id)
      vision::add_tag(scene, truth_of(id, setup_, middle), middle, testbed_.tag.side, patterns_[id - 1]);
    if (setup_.covered > 0.0) {
      Patch board;
      board.X_WP = {1.5 * kFollowSpacing, 0.0, kBoardHeight, 0.0};
      board.size = {setup_.covered, 0.5};
      board.albedo = 0.3;
      scene.patches.push_back(board);
    }
    for (std::size_t i = 0; i < renderers_.size(); ++i) {
      renderers_[i].render(scene, time, count_, frames_[i].image);
      frames_[i].time = time;
    }
    ++count_;
    return frames_;
  }

 private:
  const vision::Testbed& testbed_;
  const FollowCase& setup_;
  std::vector<Patch> clutter_;
  std::vector<vision::Renderer> renderers_;
  std::vector<vision::TagPattern> patterns_;
  std::vector<vision::Frame> frames_;
  std::uint32_t count_ = 0;
};

FollowMoment look_for_tag(vision::Positioning& positioning, std::span<const vision::Frame> frames,
                          const FollowCase& setup) {
  FollowMoment moment;
  const double before = cpu_now();
  const auto tags = positioning.update(frames);
  moment.cpu = cpu_now() - before;
  const auto found = std::ranges::find(tags, kFollowedTag, &vision::TrackedTag::id);
  if (found == tags.end()) return moment;
  const TrueTag truth = truth_of(kFollowedTag, setup, found->time);
  moment.tag = *found;
  moment.error = base::hypot(found->X_WT.x - truth.X_WT.x, found->X_WT.y - truth.X_WT.y);
  return moment;
}

bool is_same_state(const vision::TrackedTag& a, const vision::TrackedTag& b) {
  return a.time == b.time && a.X_WT.x == b.X_WT.x && a.X_WT.y == b.X_WT.y && a.X_WT.yaw == b.X_WT.yaw &&
         a.velocity == b.velocity && a.turn == b.turn && a.cameras == b.cameras;
}

/// Counts of one camera before an image, to find out what was done with it.
double search_of(const vision::CameraUse& before, const vision::CameraUse& after) {
  return after.whole > before.whole ? 2.0 : after.parts > before.parts ? 1.0 : 0.0;
}

}  // namespace

vision::Testbed follow_testbed() {
  std::string text = "dictionary = \"apriltag_36h11\"\ntag_side = 0.15\ntag_height = 0.2\n";
  for (std::size_t i = 0; i < kFollowCameras; ++i)
    text += fmt::format(
        "[[camera]]\nname = \"camera{}\"\nsize = [640, 512]\nfocal = [832, 832]\nposition = [{}, 0, 3.2]\n"
        "distortion = [-0.18, 0.06, 0.0005, -0.0004, 0]\nexposure = 0.005\nreadout = 0.015\n",
        i + 1, kFollowSpacing * static_cast<double>(i));
  return vision::parse_testbed("follow.toml", text);
}

FollowRun run_follow(const FollowCase& setup, std::uint64_t seed, const std::function<void(double)>& step,
                     double duration) {
  std::array<vision::Testbed, kFollowMethods.size()> testbeds;
  testbeds.fill(follow_testbed());
  testbeds[1].follow.emplace().tags = {kFollowedTag};
  for (std::uint32_t id = 1; id <= kFollowTags; ++id) {
    if (!testbeds[2].follow) testbeds[2].follow.emplace();
    testbeds[2].follow->tags.insert(id);
  }
  std::deque<vision::Positioning> systems;
  for (const vision::Testbed& testbed : testbeds) systems.emplace_back(testbed, 1);
  FollowStage stage(testbeds[0], setup, seed);
  FollowRun run;
  const double period = 1.0 / testbeds[0].cameras[0].camera.rate,
               end = std::min((kFollowEnd - kFollowStart) / setup.speed, duration);
  const vision::FollowCounts& counts = systems[1].follower()->counts();
  for (std::size_t n = 0; static_cast<double>(n) * period < end; ++n) {
    const double time = static_cast<double>(n) * period;
    step(time / end);
    const auto frames = stage.images(time);
    run.times.push_back(time);
    const auto before = counts.cameras;
    // The order changes, so that each method finds the images in the cache equally often.
    for (std::size_t k = 0; k < systems.size(); ++k) {
      const std::size_t method = (n + k) % systems.size();
      run.moments[method].push_back(look_for_tag(systems[method], frames, setup));
    }
    for (std::size_t i = 0; i < kFollowCameras; ++i) run.searches[i].push_back(search_of(before[i], counts.cameras[i]));
  }
  for (std::size_t method = 1; method < systems.size(); ++method)
    run.counts[method] = systems[method].follower()->counts();
  return run;
}

FollowRow summarize(const FollowRun& run, FollowMethod method) {
  const auto index = static_cast<std::size_t>(method);
  const auto &moments = run.moments[index], &reference = run.moments[0];
  FollowRow row;
  double squares = 0.0;
  std::optional<double> last;
  for (std::size_t n = 0; n < moments.size(); ++n) {
    const FollowMoment& moment = moments[n];
    row.cpu_ms += 1e3 * moment.cpu / static_cast<double>(moments.size());
    row.missed += reference[n].tag && !moment.tag ? 1 : 0;
    if (!moment.tag) continue;
    row.different += reference[n].tag && is_same_state(*moment.tag, *reference[n].tag) ? 0 : 1;
    ++row.seen;
    squares += moment.error * moment.error;
    row.most_mm = std::max(row.most_mm, 1e3 * moment.error);
    if (last) row.gap = std::max(row.gap, run.times[n] - *last);
    last = run.times[n];
  }
  if (row.seen > 0) row.rms_mm = 1e3 * std::sqrt(squares / static_cast<double>(row.seen));
  if (!run.counts[index]) return row;
  vision::CameraUse sum;
  for (const vision::CameraUse& use : run.counts[index]->cameras) {
    sum.searched += use.searched, sum.pixels += use.pixels;
    sum.asleep += use.asleep, sum.whole += use.whole, sum.parts += use.parts;
  }
  row.pixels = sum.share();
  row.asleep = static_cast<double>(sum.asleep) / static_cast<double>(std::max<std::uint64_t>(1, sum.images()));
  row.hand_overs = run.counts[index]->tags.at(kFollowedTag).hand_overs;
  return row;
}

}  // namespace sf::scenarios
