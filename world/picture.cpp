#include "world/picture.h"

#include <fmt/format.h>
#include <spng.h>

#include <memory>
#include <string_view>

#include "base/error.h"
#include "base/files.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMaxPixels = 16384;    // per side
constexpr std::size_t kMaxBytes = 300u << 20;  // of a file; the largest 8-bit PGM has 256 MiB
constexpr std::size_t kMaxInterlaced = 1u
                                       << 26;  // pixels; interlaced pictures need a second copy of four times the size
constexpr std::size_t kMaxExtras = 4u << 20;   // bytes of a PNG's text and profile chunks, uncompressed

void check_size(const std::string& file, std::uint64_t width, std::uint64_t height) {
  if (width >= 1 && height >= 1 && width <= kMaxPixels && height <= kMaxPixels) return;
  throw base::InputError(
      file, 0, fmt::format("a picture of {} x {} pixels; expected 1 to {} along each side", width, height, kMaxPixels));
}

// --- PNG
// ---------------------------------------------------------------------------------------------------------------

using Decoder = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;

void check_png(const std::string& file, int result) {
  if (result != 0) throw base::InputError(file, 0, fmt::format("broken PNG: {}; save it again", spng_strerror(result)));
}

// One row of RGBA, 8 bits each.
void take_row(Picture& picture, std::uint32_t row, const std::uint8_t* rgba, Channel channel) {
  for (std::uint32_t x = 0; x < picture.width; ++x, rgba += 4) {
    const std::size_t at = std::size_t{row} * picture.width + x;
    const int mean = (rgba[0] + rgba[1] + rgba[2]) / 3;
    picture.value[at] = channel == Channel::first ? rgba[0] : static_cast<std::uint8_t>(mean);
    if (rgba[3] >= 128) continue;
    if (picture.opaque.empty()) picture.opaque.assign(picture.value.size(), 1);
    picture.opaque[at] = 0;
  }
}

// Row by row unless interlaced, so that a large plan needs no second copy in memory.
void decode_rows(spng_ctx* png, const std::string& file, Picture& picture, Channel channel) {
  std::vector<std::uint8_t> row(std::size_t{picture.width} * 4);
  check_png(file, spng_decode_image(png, nullptr, 0, SPNG_FMT_RGBA8, SPNG_DECODE_TRNS | SPNG_DECODE_PROGRESSIVE));
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    const int result = spng_decode_row(png, row.data(), row.size());
    if (result != SPNG_EOI) check_png(file, result);
    take_row(picture, y, row.data(), channel);
  }
}

void decode_interlaced(spng_ctx* png, const std::string& file, Picture& picture, Channel channel) {
  if (picture.value.size() > kMaxInterlaced)
    throw base::InputError(file, 0,
                           fmt::format("an interlaced picture of {} x {} pixels; expected at most {} of them: save it "
                                       "without interlacing",
                                       picture.width, picture.height, kMaxInterlaced));
  std::vector<std::uint8_t> rgba(picture.value.size() * 4);
  check_png(file, spng_decode_image(png, rgba.data(), rgba.size(), SPNG_FMT_RGBA8, SPNG_DECODE_TRNS));
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    take_row(picture, y, rgba.data() + std::size_t{y} * picture.width * 4, channel);
  }
}

Picture read_png(const std::string& file, const std::string& bytes, Channel channel) {
  const Decoder png(spng_ctx_new(0), &spng_ctx_free);
  check_png(file, spng_set_png_buffer(png.get(), bytes.data(), bytes.size()));
  check_png(file, spng_set_image_limits(png.get(), 1u << 24, 1u << 24));
  check_png(file, spng_set_chunk_limits(png.get(), kMaxExtras, kMaxExtras));
  spng_ihdr header{};
  check_png(file, spng_get_ihdr(png.get(), &header));
  check_size(file, header.width, header.height);

  Picture picture{header.width, header.height, {}, {}};
  picture.value.resize(std::size_t{header.width} * header.height);
  if (header.interlace_method == 0) {
    decode_rows(png.get(), file, picture, channel);
  } else {
    decode_interlaced(png.get(), file, picture, channel);
  }
  return picture;
}

// --- PGM
// ---------------------------------------------------------------------------------------------------------------

struct Cursor {
  const std::string& file;
  std::string_view bytes;
  std::size_t at = 0;
};

[[noreturn]] void fail(const Cursor& c, const std::string& message) {
  throw base::InputError(c.file, 0, "broken PGM: " + message);
}

// The next decimal number of the header (or of a P2 body); comments run to the end of the line.
std::uint32_t next_number(Cursor& c) {
  const auto blank = [](char x) { return x == ' ' || x == '\t' || x == '\n' || x == '\r' || x == '\v' || x == '\f'; };
  while (c.at < c.bytes.size() && (blank(c.bytes[c.at]) || c.bytes[c.at] == '#')) {
    if (c.bytes[c.at] == '#') {
      while (c.at < c.bytes.size() && c.bytes[c.at] != '\n') ++c.at;
    } else {
      ++c.at;
    }
  }
  std::uint32_t value = 0;
  const std::size_t begin = c.at;
  for (; c.at < c.bytes.size() && c.bytes[c.at] >= '0' && c.bytes[c.at] <= '9'; ++c.at) {
    value = value * 10 + static_cast<std::uint32_t>(c.bytes[c.at] - '0');
    if (value > 1'000'000) fail(c, "a number is too large");
  }
  if (c.at == begin) fail(c, "expected a number; the file is cut short or not a P2 or P5 picture");
  return value;
}

std::uint32_t next_sample(Cursor& c, bool binary, std::uint32_t depth) {
  if (!binary) return next_number(c);
  const std::size_t size = depth > 255 ? 2 : 1;
  if (c.at + size > c.bytes.size()) fail(c, "fewer pixels than in its header");
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value * 256 + static_cast<std::uint8_t>(c.bytes[c.at++]);
  return value;
}

Picture read_pgm(const std::string& file, const std::string& bytes) {
  Cursor c{file, bytes, 2};
  Picture picture;
  picture.width = next_number(c);
  picture.height = next_number(c);
  check_size(file, picture.width, picture.height);
  const std::uint32_t white = next_number(c);
  if (white < 1 || white > 65535) fail(c, fmt::format("a largest value of {}; expected 1 to 65535", white));
  const bool binary = bytes[1] == '5';
  if (binary) ++c.at;  // the single blank between header and pixels

  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  if (bytes.size() - std::min(c.at, bytes.size()) < pixels) fail(c, "fewer pixels than in its header");
  picture.value.resize(pixels);
  for (std::uint8_t& value : picture.value) {
    const std::uint32_t sample = next_sample(c, binary, white);
    if (sample > white) fail(c, fmt::format("a pixel of {}, above its largest value {}", sample, white));
    value = static_cast<std::uint8_t>(sample * 255 / white);
  }
  return picture;
}

}  // namespace

Picture decode_picture(const std::string& file, const std::string& bytes, Channel channel) {
  if (bytes.starts_with("\x89PNG")) return read_png(file, bytes, channel);
  if (bytes.starts_with("P5") || bytes.starts_with("P2")) return read_pgm(file, bytes);
  throw base::InputError(file, 0, "neither a PNG nor a PGM (P2, P5) picture; convert it");
}

Picture read_picture(const std::string& file, Channel channel) {
  return decode_picture(file, base::read_bytes(file, kMaxBytes), channel);
}

}  // namespace sf::world
