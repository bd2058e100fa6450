#include "apps/reports/text.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>

#include "base/error.h"
#include "base/printable.h"

namespace sf::apps {

namespace {
bool muted = false;
std::FILE* apart = nullptr;  ///< standard output of `keep_output_apart`

std::FILE* output() { return apart != nullptr ? apart : stdout; }
}  // namespace

void keep_output_apart() {
  const int own = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  const bool is_apart = own >= 0 && dup2(STDERR_FILENO, STDOUT_FILENO) >= 0 && (apart = fdopen(own, "w")) != nullptr;
  if (!is_apart)
    throw base::InputError(std::string("standard output cannot be reserved for JSON: ") + std::strerror(errno));
}

bool flush_output() { return std::fflush(output()) == 0 && std::ferror(output()) == 0; }

void mute(bool on) { muted = on; }

void print(const std::string& text) {
  if (!muted) std::fputs(text.c_str(), output());
}

void print_message(const std::string& text) {
  if (!muted) std::fputs(("sensorfarm: " + base::printable(text) + "\n").c_str(), stderr);
}

std::string row(std::string_view name, std::string_view value) { return fmt::format("  {:<18} {}\n", name, value); }

std::string counted(std::uint64_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string join_or(const std::vector<std::string>& words) {
  if (words.size() == 1) return words.front();
  return fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

std::string list_names(const std::vector<std::string_view>& names) {
  constexpr std::size_t kMost = 10;
  if (names.empty()) return "none";
  const std::vector<std::string_view> shown(names.begin(), names.begin() + std::min(names.size(), kMost));
  return fmt::format("{}{}", fmt::join(shown, ", "),
                     names.size() > kMost ? fmt::format(", ... ({} in all)", names.size()) : "");
}

namespace {

std::string prefixed(double value, std::string_view unit, std::string (*number)(double)) {
  if (std::isinf(value)) return "-";
  if (value == 0.0) return "0";
  if (value < 1e-12) return fmt::format("< 1 p{}", unit);
  constexpr std::string_view kPrefixes[] = {"p", "n", "u", "m", ""};
  double scaled = value * 1e12;
  std::size_t at = 0;
  while (scaled >= 999.5 && at + 1 < std::size(kPrefixes)) scaled *= 1e-3, ++at;
  return fmt::format("{} {}{}", number(scaled), kPrefixes[at], unit);
}

}  // namespace

std::string quantity_text(double value, std::string_view unit) {
  return prefixed(value, unit, [](double scaled) { return fmt::format("{:.3g}", scaled); });
}
std::string bound_text(double bound, std::string_view unit) { return prefixed(bound, unit, rounded_up); }

std::string rounded_up(double value) {
  if (!(value > 0.0) || std::isinf(value)) return fmt::format("{:.3g}", value);
  const std::string nearest = fmt::format("{:.3g}", value);
  if (std::stod(nearest) >= value) return nearest;
  return fmt::format("{:.3g}", value + 0.5 * std::pow(10.0, std::floor(std::log10(value)) - 2.0));
}

}  // namespace sf::apps
