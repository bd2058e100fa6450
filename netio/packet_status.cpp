#include "netio/packet_status.h"

#include <numeric>

namespace sf::netio {

namespace {

constexpr std::string_view kNames[] = {
#define SF_TEXT(status, text) text,
    SF_PACKET_STATUSES(SF_TEXT)
#undef SF_TEXT
};

}  // namespace

std::string_view name(PacketStatus status) { return kNames[static_cast<std::size_t>(status)]; }

std::uint64_t PacketCounts::total() const { return std::accumulate(of.begin(), of.end(), std::uint64_t{0}); }

std::string packet_counts_text(const PacketCounts& counts) {
  std::string line;
  for (std::size_t i = 0; i < kPacketStatuses; ++i) {
    if (counts.of[i] == 0) continue;
    if (!line.empty()) line += ", ";
    line += std::string(kNames[i]) + " " + std::to_string(counts.of[i]);
  }
  return line.empty() ? "nothing received" : line;
}

}  // namespace sf::netio
