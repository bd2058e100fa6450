#pragma once
// Faults of sensors: their kinds, and the marks of the readings that they affect.

#include <array>
#include <cstdint>
#include <string_view>

namespace sf::base {

/// The effect of a fault on a reading (docs/scenarios.md#faults-of-sensors).
enum class FaultKind : std::uint8_t { bias, drift, scale, stuck, spikes, noise, quantization, swap, dropout, delay };

/// By FaultKind, as written in scenario files and reports.
inline constexpr std::array<std::string_view, 10> kFaultNames{"bias",  "drift",        "scale", "stuck",   "spikes",
                                                              "noise", "quantization", "swap",  "dropout", "delay"};

/// Number of readings per FaultKind.
using FaultCounts = std::array<std::uint64_t, kFaultNames.size()>;

constexpr std::uint16_t fault_bit(FaultKind kind) { return static_cast<std::uint16_t>(1u << static_cast<int>(kind)); }

/// One reading that faults affected. A lost one (dropout) is never delivered.
struct FaultMark {
  std::uint32_t mover = 0;  ///< like the following fields: see ReadingBlock
  std::uint32_t sensor = 0;
  std::uint8_t type = 0;
  std::uint32_t sequence = 0;
  std::int64_t time = 0;    ///< [ns]
  std::uint16_t kinds = 0;  ///< bit k: FaultKind k; not 0

  friend bool operator==(const FaultMark&, const FaultMark&) = default;
};

}  // namespace sf::base
