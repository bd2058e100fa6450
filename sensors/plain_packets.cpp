#include "sensors/plain_packets.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/error.h"
#include "sensors/wire_limits.h"

namespace sf::sensors {

namespace {

using Word = std::int32_t;
constexpr double kLeastWord = kNoNumber + 1.0;
constexpr double kMostWord = std::numeric_limits<Word>::max();
constexpr std::size_t kHeader = 4;  // [bytes]
constexpr std::size_t kWord = 4;    // [bytes]

Word to_word(double value, const PlainNumber& number) {
  if (number.real) return std::bit_cast<Word>(static_cast<float>(value));
  if (std::isnan(value)) return kNoNumber;
  return static_cast<Word>(std::clamp(std::round(value / number.unit), kLeastWord, kMostWord));
}

double from_word(Word word, const PlainNumber& number) {
  if (number.real) return std::bit_cast<float>(word);
  return word == kNoNumber ? std::numeric_limits<double>::quiet_NaN() : word * number.unit;
}

WireLimits wire_limits(const SensorSpec& sensor, const PlainNumber& number) {
  const auto rounded = [&](double value) { return from_word(to_word(value, number), number); };
  return {limits_of(sensor), {rounded(sensor.range_min), rounded(sensor.limit)}};
}

/// A saturated word means "this or more". The tolerance is one unit of rounding.
bool plausible(Word word, const PlainNumber& number) {
  if (number.real || word == kNoNumber) return true;
  const double value = word * number.unit;
  const bool low = word > kLeastWord && value < number.least - 0.5001 * number.unit;
  const bool high = word < kMostWord && value > number.most + 0.5001 * number.unit;
  return !low && !high;
}

/// Returns the numbers per row of a sensor, or, if that is not known, of `bytes` of rows.
std::size_t width_of(const PlainForm& form, const SensorSpec& sensor, std::size_t count = 0, std::size_t bytes = 0) {
  const std::size_t all = form.numbers.size();
  if (sensor.width != 0) return sensor.width;
  if (sensor.elements != 0 || form.fewest == 0 || count == 0) return all;
  return std::clamp<std::size_t>(bytes / (kWord * count), form.fewest, all);
}

}  // namespace

std::string plain_wire_problem(const PlainForm& form, WireFormat wire) {
  if (wire == WireFormat::farm) return "";
  return fmt::format("the thesis has no layout for {} readings: use the farm's packets (`--wire farm`)", form.name);
}

std::string plain_wire_problem(const PlainForm& form, const SensorSpec& sensor, WireFormat wire) {
  const std::size_t numbers = sensor.elements * form.numbers.size();
  if (numbers > kMaxPlainWords)
    return fmt::format("{} numbers do not fit into a packet of {} ({} at most): it can be recorded, but not sent",
                       numbers, form.name, kMaxPlainWords);
  return plain_wire_problem(form, wire);
}

std::uint8_t encode_plain(const PlainForm& form, const SensorSpec& sensor, const base::ReadingBlock& reading,
                          base::Bytes& out) {
  const std::span<const double> values = reading.values;
  const std::size_t width = width_of(form, sensor);
  SF_CHECK(values.size() == sensor.elements * width && !values.empty() && values.size() <= kMaxPlainWords,
           fmt::format("{} values of {} rows of {}", values.size(), sensor.elements, form.name));
  base::ByteWriter writer(out);
  writer.put(static_cast<std::uint16_t>(sensor.elements));
  writer.put(std::uint16_t{0});
  for (std::size_t i = 0; i < values.size(); ++i) writer.put(to_word(values[i], form.numbers[i % width]));
  return form.id;
}

PayloadPart decode_plain(const PlainForm& form, const SensorSpec& sensor, std::span<const std::uint8_t> payload,
                         std::uint8_t type, WireFormat wire) {
  if (type != form.id || wire != WireFormat::farm) return {.fault = PayloadError::out_of_range};
  base::ByteReader reader(payload);
  const std::uint32_t count = reader.get<std::uint16_t>();
  reader.get<std::uint16_t>();  // reserved
  const std::size_t width = width_of(form, sensor, count, reader.left());
  if (!reader.good() || reader.left() < kWord * width * count) return {.fault = PayloadError::too_short};
  if (reader.left() > kWord * width * count) return {.fault = PayloadError::too_long};
  const bool whole = sensor.elements == 0 || count == sensor.elements;
  if (count < 1 || !whole || count * width > kMaxPlainWords) return {.fault = PayloadError::out_of_range};
  for (std::size_t i = 0; i < count * width; ++i)
    if (!plausible(reader.get<Word>(), form.numbers[i % width])) return {.fault = PayloadError::out_of_range};
  return {.elements = count};
}

void read_plain(const PlainForm& form, const SensorSpec& sensor, std::span<const std::uint8_t> payload,
                std::span<double> values) {
  SF_CHECK(payload.size() == kHeader + kWord * values.size(),
           fmt::format("{} bytes of {} for {} values", payload.size(), form.name, values.size()));
  const std::size_t rows = base::ByteReader(payload).get<std::uint16_t>(), width = values.size() / rows;
  base::ByteReader reader(payload.subspan(kHeader));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const PlainNumber& number = form.numbers[i % width];
    values[i] = from_word(reader.get<Word>(), number);
    if (number.range && sensor.limit > 0.0) values[i] = wire_limits(sensor, number).range(values[i]);
  }
}

}  // namespace sf::sensors
