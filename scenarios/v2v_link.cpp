#include "scenarios/v2v_link.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/time.h"
#include "farm/schedule.h"
#include "netio/packets.h"
#include "robots/kinematics.h"

namespace sf::scenarios {

V2vLink::V2vLink(const V2vLinkOptions& options, std::size_t movers)
    : options_(options), kept_(base::nanoseconds(options.link.delay + options.link.jitter + options.forget)) {
  const double kept = 1e-9 * static_cast<double>(kept_) * options.rate * static_cast<double>(movers);
  if (kept > kMostKept)
    throw base::InputError(
        fmt::format("[v2v] keeps {:.0f} broadcasts of {} robots in transit; at most {:.0f} are kept: "
                    "choose a shorter delay or a lower rate",
                    kept, movers, kMostKept));
}

void V2vLink::send(std::int64_t time, std::span<const Broadcast> broadcasts, const std::vector<bool>& absent) {
  if (farm::readings_started(time, options_.rate, 0.0) <= sent_) return;
  Round round;
  if (!rounds_.empty() && rounds_.front().time < time - kept_) {
    round = std::move(rounds_.front());
    rounds_.pop_front();
  }
  round.time = time;
  round.sequence = sent_++;
  round.messages.resize(broadcasts.size());
  for (std::size_t m = 0; m < broadcasts.size(); ++m) round.messages[m] = {!absent[m], broadcasts[m]};
  rounds_.push_back(std::move(round));
}

std::optional<V2vLink::Arrived> V2vLink::newest(std::int64_t time, std::uint32_t sender, const Ids& ids) const {
  const std::uint32_t stream = static_cast<std::uint32_t>(netio::Type::v2v) << 16 | ids.sender;
  for (auto round = rounds_.rbegin(); round != rounds_.rend() && round->time >= time - kept_; ++round) {
    if (sender >= round->messages.size()) return std::nullopt;
    const Message& message = round->messages[sender];
    if (!message.sent) continue;
    const auto delay = netio::sample_delay(options_.link, {ids.receiver, stream, round->sequence});
    if (delay && round->time + *delay <= time) return Arrived{message.broadcast, round->time, round->time + *delay};
  }
  return std::nullopt;
}

std::optional<Broadcast> V2vLink::receive(std::int64_t time, std::uint32_t sender, const Ids& ids) const {
  const std::optional<Arrived> newest_one = newest(time, sender, ids);
  if (!newest_one) return std::nullopt;
  Broadcast received = newest_one->broadcast;
  received.state.time = newest_one->arrived;
  received.state = robots::extrapolate(received.state, time);
  return received;
}

}  // namespace sf::scenarios
