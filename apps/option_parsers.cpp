#include "apps/option_parsers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "world/keys.h"

namespace sf::apps {

namespace {

constexpr double kFarthest = 1e7;  ///< [m] as in world files and packets

}  // namespace

std::string check_integer(const std::string& text, std::uint64_t first, std::uint64_t last) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && stop == end && value >= first && value <= last) return "";
  return fmt::format("expected a whole number from {} to {}, got '{}'", first, last, text);
}

std::string check_number(const std::string& text, double first, double last) {
  char* stop = nullptr;
  const double value = std::strtod(text.c_str(), &stop);
  if (!text.empty() && *stop == '\0' && value >= first && value <= last) return "";
  return fmt::format("expected a number from {:g} to {:g}, got '{}'", first, last, text);
}

std::string join_or(const std::vector<std::string>& words) {
  std::string text = words.front();
  for (std::size_t i = 1; i < words.size(); ++i) text += (i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

std::string counted(std::uint64_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string row(std::string_view name, std::string_view value) { return fmt::format("  {:<18} {}\n", name, value); }

std::string check_choice(const std::string& text, const std::vector<std::string>& words) {
  const bool known = std::count(words.begin(), words.end(), text) > 0;
  return known ? "" : fmt::format("expected {}, got '{}'", join_or(words), text);
}

std::string check_not_empty(const std::string& text, const std::string& what) {
  return text.empty() ? fmt::format("expected {}, got ''", what) : "";
}

namespace {

/// A unit and how much of m or T it is.
struct Unit {
  std::string_view name;
  double value;
  bool is_tesla;
};
constexpr Unit kUnits[] = {{"m", 1.0, false},        {"cm", 1e-2, false},     {"mm", 1e-3, false}, {"um", 1e-6, false},
                           {"\u00b5m", 1e-6, false}, {"nm", 1e-9, false},     {"T", 1.0, true},    {"mT", 1e-3, true},
                           {"uT", 1e-6, true},       {"\u00b5T", 1e-6, true}, {"nT", 1e-9, true},  {"G", 1e-4, true},
                           {"mG", 1e-7, true}};

/// The number that `text` begins with, above 0 and finite, and what follows it.
std::optional<std::pair<double, std::string_view>> read_number(const std::string& text) {
  char* stop = nullptr;
  const double value = std::strtod(text.c_str(), &stop);
  if (stop == text.c_str() || !(value > 0.0) || !std::isfinite(value)) return std::nullopt;
  return std::pair{value, std::string_view(stop)};
}

}  // namespace

std::optional<Quantity> read_quantity(const std::string& text) {
  const auto number = read_number(text);
  if (!number) return std::nullopt;
  for (const Unit& unit : kUnits)
    if (unit.name == number->second) return Quantity{number->first * unit.value, unit.is_tesla};
  return std::nullopt;
}

std::string quantity_text(double value, std::string_view unit) {
  if (std::isinf(value)) return "-";
  if (value == 0.0) return "0";
  if (value < 1e-12) return fmt::format("< 1 p{}", unit);
  constexpr std::string_view kPrefixes[] = {"p", "n", "u", "m", ""};
  double scaled = value * 1e12;
  std::size_t at = 0;
  while (scaled >= 999.5 && at + 1 < std::size(kPrefixes)) scaled *= 1e-3, ++at;
  return fmt::format("{:.3g} {}{}", scaled, kPrefixes[at], unit);
}

std::optional<double> read_rate(const std::string& text) {
  const auto number = read_number(text);
  if (!number || (!number->second.empty() && number->second != "Hz")) return std::nullopt;
  return number->first;
}

std::optional<base::Pose> read_pose(const std::string& text) {
  double v[3];
  int used = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &v[0], &v[1], &v[2], &used) != 3) return std::nullopt;
  if (static_cast<std::size_t>(used) != text.size()) return std::nullopt;
  if (!std::all_of(v, v + 3, [](double value) { return std::fabs(value) <= kFarthest; })) return std::nullopt;
  return base::Pose{v[0], v[1], 0.0, v[2] * M_PI / 180.0};
}

std::optional<std::array<double, 4>> read_line(const std::string& text) {
  std::array<double, 4> v{};
  int used = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf%n", &v[0], &v[1], &v[2], &v[3], &used) != 4) return std::nullopt;
  if (static_cast<std::size_t>(used) != text.size()) return std::nullopt;
  if (!std::all_of(v.begin(), v.end(), [](double value) { return std::fabs(value) <= kFarthest; })) return std::nullopt;
  if (v[0] == v[2] && v[1] == v[3]) return std::nullopt;
  return v;
}

std::vector<std::uint16_t> read_ports(const std::string& text) {
  constexpr std::uint64_t kMostPorts = 1024;
  const std::size_t dash = text.find('-');
  const std::string first = text.substr(0, dash);
  const std::string last = dash == std::string::npos ? first : text.substr(dash + 1);
  if (!check_integer(first, 1, 65535).empty() || !check_integer(last, 1, 65535).empty()) return {};
  const std::uint64_t a = std::stoull(first);
  const std::uint64_t b = std::stoull(last);
  if (b < a || b - a >= kMostPorts) return {};
  std::vector<std::uint16_t> ports;
  for (std::uint64_t port = a; port <= b; ++port) ports.push_back(static_cast<std::uint16_t>(port));
  return ports;
}

std::string suggest_option(const std::string& word, const std::vector<std::string>& names) {
  if (word.compare(0, 2, "--") != 0) return "";
  const std::string bare = word.substr(2);
  if (std::count(names.begin(), names.end(), bare) > 0) return "; options stand after the subcommand";
  std::string found = world::suggest(bare, std::vector<std::string_view>(names.begin(), names.end()));
  const std::size_t quote = found.find('\'');
  return quote == std::string::npos ? "" : found.insert(quote + 1, "--");
}

}  // namespace sf::apps
