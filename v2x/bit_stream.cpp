#include "v2x/bit_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace sf::v2x {

namespace {

constexpr std::size_t kFragment = 16384;  ///< [byte] unit of fragmented lengths

}  // namespace

std::uint64_t BitReader::bits(unsigned count) {
  if (count > left()) fail(fmt::format("expected {} more bits, but {} are left", count, left()));
  if (!good()) return 0;
  std::uint64_t value = 0;
  while (count > 0) {
    const auto unread = static_cast<unsigned>(8 - at_ % 8);
    const unsigned taken = std::min(count, unread);
    const unsigned byte = in_[at_ / 8] >> (unread - taken);
    value = value << taken | (byte & ((1u << taken) - 1));
    at_ += taken;
    count -= taken;
  }
  return value;
}

base::Bytes BitReader::octets() {
  base::Bytes all;
  bool more = true;
  while (more && good()) {
    std::size_t length = 0;
    more = false;
    if (!bit()) {
      length = bits(7);
    } else if (!bit()) {
      length = bits(14);
    } else {
      length = bits(6) * kFragment;
      more = true;
      if (good() && (length == 0 || length > 4 * kFragment)) fail("expected a fragment of 1 to 4 times 16384 octets");
    }
    if (length * 8 > left()) fail(fmt::format("expected {} octets, but {} are left", length, left() / 8));
    for (std::size_t i = 0; i < length && good(); ++i) all.push_back(static_cast<std::uint8_t>(bits(8)));
  }
  return all;
}

std::uint8_t BitReader::small_number() {
  if (bit()) fail("an extension with a number above 63, which is not supported");
  return static_cast<std::uint8_t>(bits(6));
}

void BitReader::fail(std::string reason) {
  if (good()) reason_ = std::move(reason);
}

void BitReader::fail_within(std::string_view component) {
  const bool joined = place_.empty() || place_.front() == '[';
  place_ = fmt::format("{}{}{}", component, joined ? "" : ".", place_);
}

void BitWriter::put(std::uint64_t value, unsigned count) {
  while (count > 0) {
    if (free_ == 0) {
      out_.push_back(0);
      free_ = 8;
    }
    const unsigned taken = std::min(count, free_);
    const std::uint64_t part = (value >> (count - taken)) & ((1u << taken) - 1);
    out_.back() = static_cast<std::uint8_t>(out_.back() | part << (free_ - taken));
    free_ -= taken;
    count -= taken;
  }
}

void BitWriter::put_octets(std::span<const std::uint8_t> octets) {
  const auto put_all = [this](std::span<const std::uint8_t> part) {
    for (const std::uint8_t octet : part) put(octet, 8);
  };
  while (octets.size() >= kFragment) {
    const std::size_t units = std::min<std::size_t>(octets.size() / kFragment, 4);
    put(0b11, 2);
    put(units, 6);
    put_all(octets.first(units * kFragment));
    octets = octets.subspan(units * kFragment);
  }
  const bool is_short = octets.size() < 128;
  put(is_short ? 0b0 : 0b10, is_short ? 1 : 2);
  put(octets.size(), is_short ? 7 : 14);
  put_all(octets);
}

void BitWriter::put_small_number(std::uint64_t number) {
  SF_CHECK(number < 64, fmt::format("{} is not a small number", number));
  put(number, 7);
}

}  // namespace sf::v2x
