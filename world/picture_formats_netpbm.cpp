// Netpbm formats: bits (P1, P4), grey (P2, P5) and colour (P3, P6), as text (P1 to P3) or binary.

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "world/picture_formats.h"

namespace sf::world {

namespace {

struct Cursor {
  const std::string& file;
  std::string_view bytes;
  std::size_t at = 0;
};

struct Format {
  bool binary = false;
  std::uint32_t channels = 1;  ///< 1 or 3
  std::uint32_t white = 1;     ///< largest sample, up to 65535; 1: bits, where 1 is black
  bool bits = false;

  std::size_t bytes_per_sample() const { return white > 255 ? 2 : 1; }
};

[[noreturn]] void fail(const Cursor& c, const std::string& message) {
  throw base::InputError(c.file, 0, "corrupt Netpbm picture: " + message);
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

// If a comment starts here, skips it to the end of its line.
void skip_comment(Cursor& c) {
  if (c.at < c.bytes.size() && c.bytes[c.at] == '#')
    c.at = std::min(c.bytes.find_first_of("\n\r", c.at), c.bytes.size());
}

void skip_blanks(Cursor& c) {
  for (skip_comment(c); c.at < c.bytes.size() && is_blank(c.bytes[c.at]); skip_comment(c)) ++c.at;
}

// Skips the single blank between header and pixels, which may also end a comment (255#text), as in Netpbm. Netpbm
// counts CRLF as two, which shifts the picture; here it counts as one if all pixels follow it.
void end_header(Cursor& c, std::size_t least_bytes) {
  skip_comment(c);
  if (c.at == c.bytes.size() || !is_blank(c.bytes[c.at])) fail(c, "expected a blank between its header and its pixels");
  ++c.at;
  const bool is_crlf = c.bytes[c.at - 1] == '\r' && c.at < c.bytes.size() && c.bytes[c.at] == '\n';
  if (is_crlf && c.bytes.size() - c.at > least_bytes) ++c.at;
}

// Reads the next decimal number of the header or of a text picture.
std::uint32_t next_number(Cursor& c) {
  skip_blanks(c);
  std::uint32_t value = 0;
  const std::size_t begin = c.at;
  for (; c.at < c.bytes.size() && c.bytes[c.at] >= '0' && c.bytes[c.at] <= '9'; ++c.at) {
    value = value * 10 + static_cast<std::uint32_t>(c.bytes[c.at] - '0');
    if (value > 1'000'000) fail(c, "a number is too large");
  }
  if (c.at == begin) fail(c, "expected a number; the file is truncated or not such a picture");
  return value;
}

// Reads a bit of P1, which needs no blank before the next bit.
std::uint32_t next_bit(Cursor& c) {
  skip_blanks(c);
  if (c.at == c.bytes.size() || (c.bytes[c.at] != '0' && c.bytes[c.at] != '1'))
    fail(c, "expected 0 or 1; the file is truncated or not such a picture");
  return static_cast<std::uint32_t>(c.bytes[c.at++] - '0');
}

// Reads the next sample, scaled to 255.
std::uint8_t next_sample(Cursor& c, const Format& format) {
  if (format.bits) return next_bit(c) == 0 ? 255 : 0;
  std::uint32_t sample = 0;
  if (!format.binary) {
    sample = next_number(c);
  } else {
    for (std::size_t i = 0; i < format.bytes_per_sample(); ++i)
      sample = sample * 256 + static_cast<std::uint8_t>(c.bytes[c.at++]);
  }
  if (sample > format.white) fail(c, fmt::format("a pixel value of {}, above the maximum {}", sample, format.white));
  return static_cast<std::uint8_t>(sample * 255 / format.white);
}

void read_row(Cursor& c, const Format& format, std::vector<std::uint8_t>& rgba) {
  const std::size_t bits_at = c.at;  // of P4, whose rows are padded to bytes
  for (std::size_t x = 0; 4 * x < rgba.size(); ++x) {
    std::uint8_t* const pixel = rgba.data() + 4 * x;
    if (format.bits && format.binary) {
      pixel[0] = (static_cast<std::uint8_t>(c.bytes[bits_at + x / 8]) >> (7 - x % 8) & 1) != 0 ? 0 : 255;
    } else {
      for (std::uint32_t i = 0; i < format.channels; ++i) pixel[i] = next_sample(c, format);
    }
    if (format.channels == 1) pixel[1] = pixel[2] = pixel[0];
  }
  if (format.bits && format.binary) c.at += (rgba.size() / 4 + 7) / 8;
}

/// Returns the smallest number of bytes of all pixels.
std::size_t least_bytes(const Format& format, const PictureSink& picture) {
  if (format.bits && format.binary) return std::size_t{(picture.width() + 7) / 8} * picture.height();
  const std::size_t samples = std::size_t{picture.width()} * picture.height() * format.channels;
  return format.binary ? samples * format.bytes_per_sample() : samples;
}

}  // namespace

void decode_netpbm(const std::string& bytes, PictureSink& out) {
  Cursor c{out.file(), bytes, 2};
  const int kind = bytes[1] - '0';
  const std::uint32_t width = next_number(c);
  out.begin(width, next_number(c));
  Format format{.binary = kind > 3, .channels = kind % 3 == 0 ? 3u : 1u, .white = 1, .bits = kind % 3 == 1};
  if (!format.bits) format.white = next_number(c);
  if (format.white < 1 || format.white > 65535)
    fail(c, fmt::format("a largest value of {}; expected 1 to 65535", format.white));
  if (format.binary) end_header(c, least_bytes(format, out));
  if (bytes.size() - c.at < least_bytes(format, out)) fail(c, "fewer pixels than the header states; it is truncated");

  std::vector<std::uint8_t> rgba(std::size_t{width} * 4, 255);
  for (std::uint32_t y = 0; y < out.height(); ++y) {
    read_row(c, format, rgba);
    out.add({rgba, false});
  }
}

}  // namespace sf::world
