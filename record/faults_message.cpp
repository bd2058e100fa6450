#include "record/faults_message.h"

#include "record/cdr.h"
#include "record/ros_messages.h"

namespace sf::record {

namespace {

constexpr std::size_t kLeastFault = 24;  // [byte]
constexpr std::uint16_t kAllFaults = (1u << base::kFaultNames.size()) - 1;

}  // namespace

void encode_faults(std::int64_t time, std::span<const base::FaultMark> marks, base::Bytes& out) {
  CdrWriter cdr(out);
  put_header(cdr, time, "world");
  cdr.put_count(marks.size());
  for (const base::FaultMark& mark : marks) {
    put_time(cdr, mark.time);
    cdr.put(mark.mover);
    cdr.put(mark.sensor);
    cdr.put(mark.sequence);
    cdr.put(mark.kinds);
    cdr.put(mark.type);
  }
}

bool decode_faults(std::span<const std::uint8_t> message, std::vector<base::FaultMark>& marks) {
  CdrReader cdr(message);
  std::int64_t time = 0;
  get_header(cdr, time);
  const std::size_t before = marks.size();
  bool known = true;
  for (std::uint32_t left = cdr.get_count(kLeastFault - 1); left > 0 && cdr.good(); --left) {
    base::FaultMark& mark = marks.emplace_back();
    mark.time = get_time(cdr);
    mark.mover = cdr.get<std::uint32_t>();
    mark.sensor = cdr.get<std::uint32_t>();
    mark.sequence = cdr.get<std::uint32_t>();
    mark.kinds = cdr.get<std::uint16_t>();
    mark.type = cdr.get<std::uint8_t>();
    known = known && mark.kinds != 0 && mark.kinds <= kAllFaults;
  }
  const bool good = cdr.good() && known;
  if (!good) marks.resize(before);
  return good;
}

}  // namespace sf::record
