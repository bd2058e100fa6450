#include "world/outline_faults.h"

#include <fmt/format.h>

#include "base/error.h"

namespace sf::world {

namespace {

constexpr std::uint64_t kListedFaults = 3;  // of a kind
/// The consequence, and what further faults are.
constexpr std::array<std::array<const char*, 2>, 5> kFaultWords{
    {{": left out", "rows more are left out that cannot be read"},
     {": left out", "rows more are left out without a geometry"},
     {": left out", "rows more have points, which are left out"},
     {"", "heights more are no numbers or out of range"},
     {"", "rows more have inner rings that leave their outer ring"}}};

}  // namespace

void OutlineFaults::add(OutlineFault kind, const OutlineRow& row, const std::string& reason) {
  const auto i = static_cast<std::size_t>(kind);
  const std::string message = row.place.empty() ? reason : row.place + ": " + reason;
  if (strict_) throw base::InputError(file_, row.line, message);
  if (counts_[i]++ < kListedFaults) warnings_.push_back({file_, row.line, message + kFaultWords[i][0]});
}

void OutlineFaults::note(const std::string& message) {
  if (!message.empty()) warnings_.push_back({file_, 0, message});
}

void OutlineFaults::fail(const std::string& columns) const {
  throw base::InputError(
      file_, warnings_.empty() ? 0 : warnings_.front().line,
      fmt::format(
          "{}the file has no outlines with walls; {}; expected geometries in well-known text or binary: POLYGON, "
          "MULTIPOLYGON, LINESTRING or MULTILINESTRING",
          warnings_.empty() ? "" : warnings_.front().message + "; ", columns));
}

std::vector<Warning> OutlineFaults::take() {
  for (std::size_t i = 0; i < kFaultWords.size(); ++i)
    if (counts_[i] > kListedFaults)
      warnings_.push_back({file_, 0, fmt::format("{} {}", counts_[i] - kListedFaults, kFaultWords[i][1])});
  return std::move(warnings_);
}

}  // namespace sf::world
