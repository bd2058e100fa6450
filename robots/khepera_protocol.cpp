#include "robots/khepera_protocol.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace sf::robots {

KheperaWheels khepera_wheels(const base::Twist& twist, double track) {
  constexpr double kUnit = kKheperaPulse / 0.01;  // [m/s]
  const double forward = twist.forward / kUnit, turn = 0.5 * track * twist.turn / kUnit;
  const double fastest = std::max(std::abs(forward + turn), std::abs(forward - turn));
  if (!std::isfinite(forward) || !std::isfinite(turn) || !std::isfinite(fastest)) return {};
  const double scale = fastest > kKheperaSpeed ? kKheperaSpeed / fastest : 1.0;
  const auto whole = [&](double speed) { return static_cast<int>(std::lround(scale * speed)); };
  return {whole(forward - turn), whole(forward + turn)};
}

base::Bytes khepera_command(char letter, std::initializer_list<int> numbers) {
  std::string text(1, letter);
  for (const int number : numbers) text += ',' + std::to_string(number);
  text += '\n';
  return {text.begin(), text.end()};
}

std::optional<KheperaAnswer> parse_khepera(std::string_view line) {
  if (line.empty() || line[0] < 'a' || line[0] > 'z') return std::nullopt;
  KheperaAnswer answer{line[0], {}};
  for (line.remove_prefix(1); !line.empty();) {
    if (line[0] != ',') return std::nullopt;
    line.remove_prefix(1);
    std::int32_t number = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
    if (error != std::errc{}) return std::nullopt;
    answer.numbers.push_back(number);
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  }
  return answer;
}

std::optional<std::string> KheperaLines::take(std::uint8_t byte) {
  if (byte == '\r') return std::nullopt;
  if (byte != '\n') {
    too_long_ = too_long_ || line_.size() == kMostBytes;
    if (too_long_) ++skipped_;
    if (!too_long_) line_ += static_cast<char>(byte);
    return std::nullopt;
  }
  if (too_long_) reset();
  if (line_.empty()) return std::nullopt;
  return std::exchange(line_, {});
}

void KheperaLines::reset() {
  skipped_ += line_.size();
  line_.clear();
  too_long_ = false;
}

}  // namespace sf::robots
