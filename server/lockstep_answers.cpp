// Packets sent by lockstep: the answer of a tick as numbered datagrams, which are encoded when they are sent.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "netio/packets.h"
#include "server/lockstep.h"

namespace sf::server {

void Lockstep::publish(const base::TickRecord& record, std::int64_t now) {
  published_.take(record);
  changed_ = now;
  first_step_.reset();
  for (auto& [key, process] : processes_) {
    if (process.step && published_.tick() == process.step->tick + process.step->ticks) grant(process);
    if (process.step) first_step_ = now;
  }
  outbox_.flush();
}

void Lockstep::grant(Process& process) {
  for (const std::uint32_t mover : process.movers)
    seats_[mover].before = std::exchange(seats_[mover].answered, published_.tick());
  process.answered = published_.tick();
  process.step.reset();
  process.commands = 0;
  process.built = false;
  send(process, 0, kPushed);
}

/// Adds states and readings of its robots. With bit 0 of SUBSCRIBE, adds the states of all other robots.
void Lockstep::build_answer(Process& process) {
  if (std::exchange(process.built, true)) return;
  process.answer.clear();
  bool others = false;
  for (const std::uint32_t mover : process.movers) {
    process.answer.push_back({mover, kState, 0});
    add_readings(mover, process.answer);
    others = others || (seats_[mover].types & netio::kNeighboursBit) != 0;
  }
  for (const auto& [id, mover] : names_.robots)
    if (others && seats_[mover].driver != &process) process.answer.push_back({mover, kState, 0});
}

/// Adds the newest reading of each sensor delivered since the previous answer.
void Lockstep::add_readings(std::uint32_t mover, std::vector<Part>& parts) {
  const Seat& seat = seats_[mover];
  rows_.clear();
  published_.find_new(mover, seat.types == 0 ? ~netio::kNeighboursBit : seat.types, seat.before, rows_);
  for (const std::uint32_t row : rows_) {
    const auto total = static_cast<std::uint32_t>(published_.reading(row).values.size());
    for (std::uint32_t first = 0; first < total; first += netio::kMaxValues) parts.push_back({mover, row, first});
  }
}

void Lockstep::answer_again(Process& process, std::uint32_t first, std::uint32_t count) {
  if (again_ >= kMaxAnswers) return;
  const std::uint64_t before = process.states + process.values;
  send(process, first, count);
  again_ += process.states + process.values - before;
  counts_.fetched += process.states + process.values - before;
}

void Lockstep::send(Process& process, std::uint32_t first, std::uint32_t count) {
  build_answer(process);
  const std::uint64_t end = std::min<std::uint64_t>(process.answer.size(), std::uint64_t{first} + count);
  for (std::uint64_t i = first; i < end; ++i) {
    encode(process, static_cast<std::uint32_t>(i));
    // States of other processes' robots are signed like those of the process's first robot.
    const std::uint32_t mover = process.answer[i].mover;
    const std::uint32_t signs = seats_[mover].driver == &process ? mover : process.movers.front();
    outbox_.queue(process.endpoint, packet_, {inbox_.session(), process.session},
                  inbox_.signer(world_.movers[signs].id));
  }
}

void Lockstep::encode(Process& process, std::uint32_t index) {
  const Part& part = process.answer[index];
  const netio::AnswerPart place{published_.tick(), index, static_cast<std::uint32_t>(process.answer.size())};
  netio::Header header{.robot = static_cast<std::uint16_t>(world_.movers[part.mover].id), .time = published_.time()};
  if (part.reading == kState) {
    header.sequence = process.states++;
    const base::Report& report = published_.report(part.mover);
    return netio::encode(header,
                         netio::State{place, report.X_WM, report.velocity, published_.contact(part.mover) ? 1u : 0u,
                                      counts_.lost_robots > 0 ? netio::kDriverLostBit : 0u, report.tilt},
                         packet_);
  }
  const base::ReadingBlock& reading = published_.reading(part.reading);
  const auto total = static_cast<std::uint32_t>(reading.values.size());
  const auto values = reading.values.subspan(part.first, netio::count_values(total, part.first));
  header.sensor = static_cast<std::uint16_t>(reading.sensor);
  header.sequence = process.values++;
  header.time = reading.time;
  // Receivers cannot see which elements are flagged, so `error` is given only if it holds for all of them.
  const bool unsure = base::is_unsure(reading);
  const double error = unsure ? HUGE_VAL : reading.bound;
  // A bound of 0 (for example without magnets) is encoded as the smallest value, because 0 means "no bound" in this
  // word.
  const double bound = std::max(reading.bound, std::numeric_limits<double>::min());
  header.accuracy = netio::encode_accuracy({reading.mode, unsure, bound});
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes());
  netio::encode(header, netio::Values{place, reading.type, total, part.first, reading.X_WS, error, bytes}, packet_);
}

}  // namespace sf::server
