#include "world/outline_faults.h"

#include <fmt/format.h>

#include "base/error.h"

namespace sf::world {

namespace {

constexpr std::uint64_t kListedFaults = 3;  // per kind
/// The consequence of each fault, and the plural for further faults.
constexpr std::array<std::array<const char*, 2>, 7> kFaultWords{
    {{": left out", "more rows cannot be read and are left out"},
     {": left out", "more rows have no geometry and are left out"},
     {": left out", "more rows have points, which are left out"},
     {": left out", "more rows have three-dimensional faces, which are left out"},
     {": using the height of the model", "more heights are not numbers or are out of range"},
     {": its walls are thin", "more rows have inner rings that leave their outer ring"},
     {": ignored", "more rows have text after a closing quote"}}};

}  // namespace

void OutlineFaults::add(OutlineFault kind, const OutlineRow& row, const std::string& reason) {
  if (counts_[static_cast<std::size_t>(kind)]++ >= kListedFaults) return;
  faults_.push_back({kind, row.line, row.place.empty() ? reason : row.place + ": " + reason});
}

void OutlineFaults::note(const std::string& message) {
  if (!message.empty()) notes_.push_back(message);
}

void OutlineFaults::refuse() const {
  if (!faults_.empty()) throw base::InputError(file_, faults_.front().line, faults_.front().reason);
}

void OutlineFaults::fail(const std::string& columns) const {
  throw base::InputError(
      file_, faults_.empty() ? 0 : faults_.front().line,
      fmt::format(
          "{}the file has no outlines with walls; {}; expected geometries in well-known text or binary: POLYGON, "
          "MULTIPOLYGON, LINESTRING or MULTILINESTRING",
          faults_.empty() ? "" : faults_.front().reason + "; ", columns));
}

std::vector<Warning> OutlineFaults::warnings() const {
  std::vector<Warning> all;
  for (const Fault& fault : faults_)
    all.push_back({file_, fault.line, fault.reason + kFaultWords[static_cast<std::size_t>(fault.kind)][0]});
  for (std::size_t i = 0; i < kFaultWords.size(); ++i)
    if (counts_[i] > kListedFaults)
      all.push_back({file_, 0, fmt::format("{} {}", counts_[i] - kListedFaults, kFaultWords[i][1])});
  for (const std::string& note : notes_) all.push_back({file_, 0, note});
  return all;
}

}  // namespace sf::world
