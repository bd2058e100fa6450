#include "scenarios/state_link.h"

#include <algorithm>
#include <tuple>

#include "base/random.h"
#include "base/time.h"
#include "farm/schedule.h"
#include "netio/sender_bindings.h"
#include "robots/fleet.h"
#include "robots/kinematics.h"

namespace sf::scenarios {

namespace {

constexpr auto kStream = static_cast<std::uint32_t>(netio::Type::v2v) << 16;

server::StateFilterOptions filter_options(const StateLinkOptions& options) {
  server::StateFilterOptions filter;
  filter.mode = options.filter ? server::FilterMode::on : server::FilterMode::off;
  filter.policy = estimation::StalePolicy::freeze;
  filter.clock.least_delay = base::nanoseconds(options.link.delay);
  filter.stale_after += base::nanoseconds(options.link.delay + options.link.jitter);
  return filter;
}

}  // namespace

StateLink::StateLink(const world::World& world, const StateLinkOptions& options)
    : world_(world),
      options_(options),
      filter_(world, filter_options(options)),
      newest_(robots::states_at_load(world)),
      sequences_(world.movers.size()) {}

void StateLink::add_mover(const base::Report& state) {
  filter_.add_mover();
  newest_.push_back(state);
  sequences_.emplace_back();
}

std::span<const base::Report> StateLink::pass(std::int64_t time, std::span<const base::Report> truth) {
  if (farm::readings_started(time, options_.rate, 0.0) > sent_) send(time, truth);
  std::sort(on_the_way_.begin(), on_the_way_.end(), [](const Message& a, const Message& b) {
    return std::tuple(a.arrival, a.report.mover, a.sequence) < std::tuple(b.arrival, b.report.mover, b.sequence);
  });
  const auto arrived =
      std::find_if(on_the_way_.begin(), on_the_way_.end(), [&](const Message& m) { return m.arrival > time; });
  std::for_each(on_the_way_.begin(), arrived, [&](const Message& m) { take(m); });
  on_the_way_.erase(on_the_way_.begin(), arrived);

  known_.assign(truth.begin(), truth.end());
  const auto use = [&](const base::Report& state) {
    known_[state.mover].X_WM = state.X_WM;
    known_[state.mover].velocity = state.velocity;
  };
  for (base::Report& report : known_) {
    if (world_.movers[report.mover].is_tag) continue;
    use(robots::extrapolate(newest_[report.mover], time));
  }
  if (options_.filter)
    for (const base::Report& report : filter_.predict(time)) use(report);
  return known_;
}

void StateLink::send(std::int64_t time, std::span<const base::Report> truth) {
  for (const base::Report& state : truth) {
    const world::Mover& mover = world_.movers[state.mover];
    if (mover.is_tag) continue;
    const auto delay = netio::sample_delay(options_.link, {mover.id, kStream, sent_});
    if (!delay) continue;
    const base::RandomKey draw{options_.link.seed, base::RandomStream::link, mover.id, kStream + 1, sent_};
    const auto along = base::random_normal(draw, 0), turned = base::random_normal(draw, 1);
    Message message{time + *delay, sent_, state};
    message.report.time = time;
    message.report.X_WM.x += options_.position_sigma * along[0];
    message.report.X_WM.y += options_.position_sigma * along[1];
    message.report.X_WM.yaw += options_.yaw_sigma * turned[0];
    on_the_way_.push_back(message);
  }
  ++sent_;
}

void StateLink::take(const Message& message) {
  const std::uint32_t row = message.report.mover;
  if (options_.filter) {
    netio::Header header;
    header.time = message.report.time;
    header.sequence = message.sequence;
    filter_.take(message.report, header, message.arrival);
  }
  if (sequences_[row] && !netio::newer(message.sequence, *sequences_[row])) return;
  sequences_[row] = message.sequence;
  newest_[row] = message.report;
  newest_[row].time = message.arrival;
}

}  // namespace sf::scenarios
