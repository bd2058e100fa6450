// `robot`: one simulated robot as a process of its own, beside a farm that serves. `start`: the signal to begin.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "apps/commands.h"
#include "apps/lend.h"
#include "apps/plan.h"
#include "apps/post.h"
#include "apps/robot_facts.h"
#include "apps/robot_link.h"
#include "apps/stop.h"
#include "apps/wire_names.h"
#include "base/error.h"
#include "scenarios/robot_body.h"
#include "world/keys.h"
#include "world/lights.h"
#include "world/roads/roads.h"

namespace sf::apps {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t kAnswerIn = 3'000'000'000;  ///< [ns] without one, the user is told

std::uint32_t find_robot(const world::World& world, const std::string& name) {
  std::vector<std::string_view> names;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i) {
    if (world.movers[i].is_tag) continue;
    if (world.movers[i].name == name) return i;
    names.emplace_back(world.movers[i].name);
  }
  const std::string nearest = world::suggest(name, names);
  throw base::InputError(
      world.file, 0,
      "has no robot '" + name + "'" + (nearest.empty() ? "; `sensorfarm check` lists its models" : nearest));
}

/// Whether it is to wait for the start signal: by its own option, or by the control shell's setting.
bool waits(const Options& options) {
  return options.wait_for_start || std::count(options.set.begin(), options.set.end(), "start=signal") > 0;
}

/// Within what a packet may say, whatever the world file lets a robot do.
netio::V2v state_of(const base::Report& report, const base::Intent& intent) {
  const auto bound = [](double value, double most) { return std::clamp(value, -most, most); };
  netio::V2v state;
  state.X_WR = {bound(report.X_WM.x, netio::kMaxPosition), bound(report.X_WM.y, netio::kMaxPosition),
                bound(report.X_WM.z, netio::kMaxPosition), base::wrap_angle(report.X_WM.yaw)};
  state.velocity = {bound(report.velocity.forward, netio::kMaxSpeed), bound(report.velocity.left, netio::kMaxSpeed),
                    bound(report.velocity.turn, netio::kMaxSpeed)};
  state.follows = intent.follows <= netio::kMaxId ? intent.follows : netio::kNone;
  state.checkpoint = intent.checkpoint;
  state.docking = intent.docking;
  return state;
}

/// The controller and all that it is given. World, roster and options must outlive it.
class RobotProcess {
 public:
  RobotProcess(const world::World& world, const sensors::Roster& roster, std::uint32_t mover, const Options& options)
      : world_(world),
        names_(wire_names(world)),
        mover_(mover),
        body_(world, mover),
        link_(world, roster, mover, options,
              [this](const netio::Packet& packet, std::int64_t now) { hear(packet, now); }),
        intents_(world.movers.size()),
        started_(!waits(options)) {
    std::vector<world::Warning> warnings;
    if (!world.road_files.empty()) roads_ = world::load_roads(world.road_files.front(), warnings);
    control::Plan plan = plan_of(options);
    plan.rate = options.rate;
    made_ = control::make_controller({world, mover, options.seed, roads_ ? &*roads_ : nullptr}, std::move(plan));
  }

  double rate() const { return made_.rate; }
  bool done() const { return started_ && made_.controller->done(); }
  const RobotLink& link() const { return link_; }

  /// Takes in and lets out what comes and is due until `until`.
  template <class Now>
  void wait_until(std::int64_t until, Now&& now) {
    link_.run(now());
    for (std::int64_t time = now(); time < until && !stop_requested(); time = now()) {
      link_.wait(time, until);
      link_.run(now());
    }
  }

  /// Moves as it decided last, decides anew, and says where it is.
  void turn(std::int64_t now) {
    body_.move(command_, now);
    contacts_ += body_.contact();
    command_ = {};
    if (started_) decide(now);
    link_.say(state_of(body_.state(), made_.controller->intent()), now);
    complain(now);
  }

  RobotFacts facts(const Options& options) const {
    RobotFacts facts;
    facts.robot = world_.movers[mover_].name;
    facts.id = world_.movers[mover_].id;
    facts.controller = options.controller;
    facts.farm = netio::text(link_.farm());
    facts.steps = steps_;
    facts.started = started_;
    facts.done = done();
    facts.answered = link_.answered();
    facts.link = link_.counts();
    facts.contacts = contacts_;
    facts.distance_m = body_.distance();
    facts.pose = body_.state().X_WM;
    if (errors_ > 0) {
      const auto count = static_cast<double>(errors_);
      facts.error = {errors_, error_sum_ / count, abs_error_sum_ / count};
    }
    return facts;
  }

 private:
  void hear(const netio::Packet& packet, std::int64_t now) {
    const auto* state = std::get_if<netio::V2v>(&packet.body);
    if (state == nullptr) {
      started_ = true;
      return;
    }
    const std::uint32_t row = names_.robots.at(packet.header.robot);
    intents_[row] = {state->follows, state->checkpoint, state->docking};
    body_.hear(row, state->X_WR, state->velocity, now);
  }

  void decide(std::int64_t now) {
    gather_readings();
    gather_others(now);
    gather_signals(now);
    control::Input input{now, body_.state(), readings_, body_.contact(), started_, others_, signals_};
    input.state.time = now;
    command_ = made_.controller->step(input);
    ++steps_;
    const double error = made_.controller->error();
    if (!std::isfinite(error)) return;
    ++errors_;
    error_sum_ += error;
    abs_error_sum_ += std::abs(error);
  }

  /// Packets do not say where the farm took the robot to be: it goes by where it was itself.
  void gather_readings() {
    readings_.clear();
    for (RobotLink::Newest& newest : link_.readings()) {
      base::ReadingBlock& block = readings_.emplace_back(newest.block);
      block.X_WM = body_.pose_at(block.time);
      block.X_WS = base::compose(block.X_WM, newest.row->X_MS);
    }
  }

  void gather_others(std::int64_t now) {
    others_.clear();
    const double radio = made_.controller->radio();
    if (radio <= 0.0) return;
    const base::Pose& own = body_.state().X_WM;
    for (const auto& [id, row] : names_.robots) {
      if (row == mover_ || !link_.heard(id, now)) continue;
      base::Report state = body_.state(row);
      state.time = now;
      if (std::hypot(state.X_WM.x - own.x, state.X_WM.y - own.y) <= radio)
        others_.push_back({id, state, intents_[row]});
    }
  }

  /// Lights go by the farm's clock.
  void gather_signals(std::int64_t now) {
    const double time = 1e-9 * static_cast<double>(link_.clock().farm(now));
    signals_.clear();
    for (const world::Light& light : world_.lights) signals_.push_back(world::signal_at(light, time));
  }

  void complain(std::int64_t now) {
    if (complained_ || !link_.listens() || now - link_.last_answer() < kAnswerIn) return;
    complained_ = true;
    std::fprintf(stderr,
                 "sensorfarm: nothing came from the farm at %s for 3 s; is `sensorfarm serve` running there with this "
                 "world and these ports? Going on\n",
                 netio::text(link_.farm()).c_str());
  }

  const world::World& world_;
  WireNames names_;
  std::uint32_t mover_;
  scenarios::RobotBody body_;
  RobotLink link_;
  std::optional<world::RoadNetwork> roads_;
  control::Made made_;
  std::vector<base::Intent> intents_;  ///< per mover, as told
  base::Twist command_;
  bool started_;
  bool complained_ = false;
  std::uint64_t steps_ = 0;
  std::uint64_t contacts_ = 0;
  std::uint64_t errors_ = 0;
  double error_sum_ = 0.0;
  double abs_error_sum_ = 0.0;
  std::vector<base::ReadingBlock> readings_;
  std::vector<control::Neighbour> others_;
  std::vector<world::Signal> signals_;
};

}  // namespace

int robot(const Options& options) {
  const world::World world = load_with_robots(options.world, options.load, 0, options.seed);
  const sensors::Roster roster(world);
  const std::uint32_t mover = find_robot(world, options.robot);
  require_sendable(world, roster, options);
  RobotProcess process(world, roster, mover, options);
  catch_stop_signals();
  std::fprintf(stderr, "sensorfarm: %s (id %u) drives by '%s' at %g Hz beside the farm at %s%s; Ctrl-C ends it\n",
               world.movers[mover].name.c_str(), world.movers[mover].id, options.controller.c_str(), process.rate(),
               netio::text(process.link().farm()).c_str(), waits(options) ? ", once it is given the start signal" : "");

  const auto start = Clock::now();
  const auto now = [&] { return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start).count(); };
  const std::int64_t period = std::llround(1e9 / process.rate());
  const std::int64_t end = options.duration > 0.0 ? std::llround(1e9 * options.duration) : INT64_MAX;
  for (std::int64_t next = 0; !stop_requested() && !process.done(); next = std::max(next + period, now() - period)) {
    process.wait_until(std::min(next, end), now);
    if (stop_requested() || now() >= end) break;
    process.turn(now());
  }

  RobotFacts facts = process.facts(options);
  facts.wall_s = 1e-9 * static_cast<double>(now());
  std::fputs((options.json ? json_of(facts) : text_of(facts)).c_str(), stdout);
  return 0;
}

int start(const Options& options) {
  constexpr int kTimes = 3;  // one may be lost on the way
  const netio::Endpoint farm{netio::resolve(options.server), static_cast<std::uint16_t>(options.port)};
  netio::Header header;
  header.robot = static_cast<std::uint16_t>(options.start_id);
  netio::Outbox outbox;
  base::Bytes packet;
  for (int i = 0; i < kTimes; ++i) {
    if (i > 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    header.sequence = static_cast<std::uint32_t>(i);
    netio::encode(header, netio::Start{}, packet);
    outbox.queue(farm, packet);
    outbox.flush();
  }
  if (outbox.counts().sent == 0)
    throw base::InputError("the start signal was not sent: " + outbox.counts().first_failure);
  std::fprintf(
      stderr, "sensorfarm: start signal sent to %s for %s\n", netio::text(farm).c_str(),
      options.start_id == netio::kEveryone ? "all robots" : ("robot " + std::to_string(options.start_id)).c_str());
  return 0;
}

}  // namespace sf::apps
