#include "record/fleet_message.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/tilted_pose.h"
#include "record/cdr.h"
#include "record/ros_messages.h"

namespace sf::record {

namespace {

void put_twist(CdrWriter& cdr, const base::Twist& twist) {
  for (const double value : {twist.forward, twist.left, twist.turn}) cdr.put(value);
}

void get_twist(CdrReader& cdr, base::Twist& twist) {
  for (double* value : {&twist.forward, &twist.left, &twist.turn}) *value = cdr.get<double>();
}

bool is_tilted(const base::Report& report) { return !base::is_level(report.tilt) && !base::is_absent(report.X_WM); }

bool has_wheels(const base::Report& report) { return report.wheels.are_known() && !base::is_absent(report.X_WM); }

/// Appends a sequence with the values, two numbers each, of the movers that `has` accepts.
template <class Value>
void put_values(CdrWriter& cdr, const base::TickRecord& record, bool (*has)(const base::Report&),
                Value base::Report::*value) {
  cdr.put_count(static_cast<std::size_t>(std::ranges::count_if(record.reports, has)));
  for (const base::Report& report : record.reports) {
    if (!has(report)) continue;
    cdr.put(report.mover);
    const auto& [first, second] = report.*value;
    cdr.put(first), cdr.put(second);
  }
}

template <class Value>
bool decode_values(std::span<const std::uint8_t> message, MoverValues<Value>& sample) {
  CdrReader cdr(message);
  get_header(cdr, sample.time);
  sample.movers.resize(cdr.get_count(sizeof(std::uint32_t) + sizeof(Value)));
  bool finite = true;
  for (auto& [mover, value] : sample.movers) {
    auto& [first, second] = value;
    mover = cdr.get<std::uint32_t>();
    first = cdr.get<decltype(first)>(), second = cdr.get<decltype(second)>();
    finite = finite && std::isfinite(first + second);
  }
  return cdr.good() && finite;
}

}  // namespace

bool any_tilted(const base::TickRecord& record) { return std::ranges::any_of(record.reports, is_tilted); }

void put_tilts(CdrWriter& cdr, const base::TickRecord& record) {
  put_values(cdr, record, is_tilted, &base::Report::tilt);
}

void encode_tilts(const base::TickRecord& record, base::Bytes& out) {
  CdrWriter cdr(out);
  put_header(cdr, record.time, "world");
  put_tilts(cdr, record);
}

bool decode_tilts(std::span<const std::uint8_t> message, TiltsSample& sample) { return decode_values(message, sample); }

bool any_wheels(const base::TickRecord& record) { return std::ranges::any_of(record.reports, has_wheels); }

void encode_wheels(const base::TickRecord& record, base::Bytes& out) {
  CdrWriter cdr(out);
  put_header(cdr, record.time, "world");
  put_values(cdr, record, has_wheels, &base::Report::wheels);
}

bool decode_wheels(std::span<const std::uint8_t> message, WheelsSample& sample) {
  return decode_values(message, sample);
}

void encode_fleet(const base::TickRecord& record, base::Bytes& out) {
  const std::size_t count = record.reports.size();
  SF_CHECK(record.commands.empty() || record.commands.size() == count, std::to_string(record.commands.size()));
  SF_CHECK(record.contacts.empty() || record.contacts.size() == count, std::to_string(record.contacts.size()));

  CdrWriter cdr(out);
  put_header(cdr, record.time, "world");
  cdr.put(record.tick);
  cdr.put_count(count);
  for (std::size_t i = 0; i < count; ++i) {
    const base::Report& report = record.reports[i];
    cdr.put(report.mover);
    cdr.put(!record.contacts.empty() && record.contacts[i] != 0);
    for (const double value : {report.X_WM.x, report.X_WM.y, report.X_WM.z, report.X_WM.yaw}) cdr.put(value);
    put_twist(cdr, report.velocity);
    put_twist(cdr, record.commands.empty() ? base::Twist{} : record.commands[i]);
  }
}

bool decode_fleet(std::span<const std::uint8_t> message, FleetState& fleet) {
  constexpr std::size_t kLeastState = 85;  // [byte]
  CdrReader cdr(message);
  get_header(cdr, fleet.time);
  fleet.tick = cdr.get<std::uint64_t>();
  fleet.states.resize(cdr.get_count(kLeastState));
  for (MoverState& state : fleet.states) {
    state.mover = cdr.get<std::uint32_t>();
    state.contact = cdr.get<bool>();
    base::Pose& pose = state.X_WM;
    for (double* value : {&pose.x, &pose.y, &pose.z, &pose.yaw}) *value = cdr.get<double>();
    get_twist(cdr, state.velocity);
    get_twist(cdr, state.command);
  }
  return cdr.good();
}

}  // namespace sf::record
