#include "record/fleet_message.h"

#include "base/error.h"
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

}  // namespace

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
