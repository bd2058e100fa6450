#include "netio/laser_packets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace sf::netio {

namespace {

constexpr double kPlainPerMetre = 1e3;
constexpr double kExtendedPerMetre = 1e4;
constexpr std::size_t kPartHeaderBytes = 16;
static_assert(kHeaderBytes + kPartHeaderBytes + 4 * kPartRays <= kMaxDatagram);

template <class Word>
Word to_word(double metres, double per_metre, Word largest) {
  const double units = std::floor(metres * per_metre + 0.5);
  if (!(units > 0.0)) return 0;
  return units >= static_cast<double>(largest) ? largest : static_cast<Word>(units);
}

std::uint16_t plain_word(double metres) { return to_word<std::uint16_t>(metres, kPlainPerMetre, 0xFFFF); }

std::uint32_t extended_word(double metres) {
  if (metres == std::numeric_limits<double>::infinity()) return kNoReturn;
  return to_word<std::uint32_t>(metres, kExtendedPerMetre, kNoReturn - 1);
}

std::uint32_t parts_of(std::uint32_t rays) { return (rays + kPartRays - 1) / kPartRays; }

void put_plain(std::span<const double> ranges, base::ByteWriter& writer) {
  writer.put(static_cast<std::uint16_t>(ranges.size()));
  for (const double metres : ranges) writer.put(plain_word(metres));
}

void put_extended(std::uint32_t total, std::uint32_t part, std::span<const double> ranges, base::ByteWriter& writer) {
  writer.put(total);
  writer.put(part * kPartRays);
  writer.put(static_cast<std::uint16_t>(part));
  writer.put(static_cast<std::uint16_t>(parts_of(total)));
  writer.put(static_cast<std::uint16_t>(ranges.size()));
  writer.put(std::uint16_t{0});
  for (const double metres : ranges) writer.put(extended_word(metres));
}

bool has_nan(std::span<const double> ranges) {
  return std::any_of(ranges.begin(), ranges.end(), [](double metres) { return std::isnan(metres); });
}

Reason take_words(std::span<const std::uint8_t> rest, std::size_t word, LaserPart& scan) {
  if (rest.size() < scan.count * word) return Reason::too_short;
  if (rest.size() > scan.count * word) return Reason::too_long;
  scan.words = rest;
  return Reason::accepted;
}

}  // namespace

bool fits_plain(std::uint32_t samples, double range_max) { return samples <= kLaserRays && range_max <= kLaserRange; }

std::uint32_t laser_parts(Wire wire, std::uint32_t samples, double range_max) {
  return wire == Wire::thesis || fits_plain(samples, range_max) ? 1 : parts_of(samples);
}

void require_wire(Wire wire, std::uint32_t samples, double range_max, const std::string& sensor) {
  if (samples > kExtendedRays) {
    throw base::InputError(sensor + ": " + std::to_string(samples) + " samples, but a scan is sent with at most " +
                           std::to_string(kExtendedRays) + ": lower `samples`");
  }
  if (wire == Wire::farm || fits_plain(samples, range_max)) return;
  throw base::InputError(sensor + ": " + std::to_string(samples) + " samples up to " + std::to_string(range_max) +
                         " m do not fit the thesis' layout, which holds 361 rays up to 65.535 m: lower `samples` or "
                         "`range_max`, or send the farm's own packets (`--wire farm`)");
}

bool encode_laser(Wire wire, const Header& header, std::span<const double> ranges, double range_max, std::uint32_t part,
                  base::Bytes& out) {
  const auto total = static_cast<std::uint32_t>(ranges.size());
  SF_CHECK(total >= 1 && total <= kExtendedRays && part < laser_parts(wire, total, range_max),
           "part " + std::to_string(part) + " of a scan of " + std::to_string(ranges.size()) + " rays");
  const bool plain = fits_plain(total, range_max);
  SF_CHECK(plain || wire == Wire::farm, "a scan of " + std::to_string(total) + " rays in the thesis' layout");

  out.clear();
  const auto mine = plain ? ranges : ranges.subspan(part * kPartRays, std::min(kPartRays, total - part * kPartRays));
  if (has_nan(mine)) return false;
  base::ByteWriter writer(out);
  Header own = header;
  own.type = plain ? Type::laser : Type::laser_extended;
  if (wire == Wire::farm) put_header(own, writer);
  if (plain) {
    put_plain(mine, writer);
  } else {
    put_extended(total, part, mine, writer);
  }
  return true;
}

double range(const LaserPart& scan, std::uint32_t i) {
  SF_CHECK(i < scan.count, "ray " + std::to_string(i) + " of " + std::to_string(scan.count));
  if (!scan.extended)
    return base::ByteReader(scan.words.subspan(2 * std::size_t{i})).get<std::uint16_t>() / kPlainPerMetre;
  const auto word = base::ByteReader(scan.words.subspan(4 * std::size_t{i})).get<std::uint32_t>();
  return word == kNoReturn ? std::numeric_limits<double>::infinity() : word / kExtendedPerMetre;
}

Reason read_laser(std::span<const std::uint8_t> payload, LaserPart& scan) {
  base::ByteReader reader(payload);
  scan = {};
  scan.total = scan.count = reader.get<std::uint16_t>();
  if (!reader.good()) return Reason::too_short;
  const Reason size = take_words(payload.subspan(reader.position()), 2, scan);
  if (size != Reason::accepted) return size;
  return scan.count >= 1 && scan.count <= kLaserRays ? Reason::accepted : Reason::out_of_range;
}

Reason read_laser_extended(std::span<const std::uint8_t> payload, LaserPart& scan) {
  base::ByteReader reader(payload);
  scan = {};
  scan.extended = true;
  scan.total = reader.get<std::uint32_t>();
  scan.first = reader.get<std::uint32_t>();
  scan.part = reader.get<std::uint16_t>();
  scan.parts = reader.get<std::uint16_t>();
  scan.count = reader.get<std::uint16_t>();
  reader.get<std::uint16_t>();  // reserved
  if (!reader.good()) return Reason::too_short;
  const Reason size = take_words(payload.subspan(reader.position()), 4, scan);
  if (size != Reason::accepted) return size;

  // The split is fixed, so each field follows from the total and the part: nothing a receiver adds up can surprise it.
  if (scan.total < 1 || scan.total > kExtendedRays) return Reason::out_of_range;
  if (scan.parts != parts_of(scan.total) || scan.part >= scan.parts) return Reason::out_of_range;
  if (scan.first != scan.part * kPartRays) return Reason::out_of_range;
  return scan.count == std::min(kPartRays, scan.total - scan.first) ? Reason::accepted : Reason::out_of_range;
}

}  // namespace sf::netio
