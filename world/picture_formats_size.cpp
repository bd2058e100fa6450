// Reads sizes from the headers of pictures that the plug-in decodes.

#include <algorithm>
#include <string_view>

#include "base/error.h"
#include "world/picture_formats.h"

namespace sf::world {

namespace {

constexpr int kMaxScans = 100;  // per progressive JPEG, usually about ten; each takes as long as the whole picture

struct Bytes {
  const std::string& file;
  std::string_view bytes;

  [[noreturn]] void fail(const std::string& message) const { throw base::InputError(file, 0, message); }
  std::uint64_t byte(std::size_t at) const {
    if (at >= bytes.size()) fail("the picture is truncated; save it again");
    return static_cast<std::uint8_t>(bytes[at]);
  }
  std::uint64_t big16(std::size_t at) const { return byte(at) << 8 | byte(at + 1); }
  std::uint64_t little16(std::size_t at) const { return byte(at + 1) << 8 | byte(at); }
  std::uint64_t little32(std::size_t at) const { return little16(at + 2) << 16 | little16(at); }
};

bool is_frame(std::uint64_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

// Finds the next marker after the entropy-coded data of a scan, in which 0xFF is followed by 0 or a restart marker.
std::size_t behind_scan(const Bytes& b, std::size_t at) {
  for (;; ++at) {
    at = std::min(b.bytes.find('\xFF', at), b.bytes.size());
    const std::uint64_t next = b.byte(at + 1);
    if (next != 0 && next != 0xFF && (next < 0xD0 || next > 0xD7)) return at;
  }
}

// ITU-T T.81, annex B: markers from the start of the image to its end.
PictureSize jpeg_size(const Bytes& b) {
  PictureSize size;
  int scans = 0;
  for (std::size_t at = 2;;) {
    if (b.byte(at) != 0xFF) b.fail("corrupt JPEG: expected a marker; save it again");
    const std::uint64_t marker = b.byte(at + 1);
    if (marker == 0xD9) break;
    if (marker == 0xFF) {  // a fill byte
      ++at;
      continue;
    }
    if (is_frame(marker)) size = {b.big16(at + 7), b.big16(at + 5)};
    at += 2 + b.big16(at + 2);
    if (marker != 0xDA) continue;
    if (++scans > kMaxScans) b.fail("a JPEG of more than 100 scans; save it without progressive coding");
    at = behind_scan(b, at);
  }
  if (scans == 0) b.fail("corrupt JPEG: it has no pixels; save it again");
  return size;
}

// A negative height means that the top row comes first. The OS/2 header has 16-bit sizes.
PictureSize bmp_size(const Bytes& b) {
  const bool is_os2 = b.little32(14) == 12;
  const std::uint64_t up = is_os2 ? b.little16(20) : b.little32(22);
  const PictureSize size{is_os2 ? b.little16(18) : b.little32(18), up < 0x80000000u ? up : 0x100000000u - up};
  const std::uint64_t compression = is_os2 ? 0 : b.little32(30);
  const std::uint64_t row = (size.width * b.little16(is_os2 ? 24 : 28) + 31) / 32 * 4;  // [byte]
  const bool fixed = compression == 0 || compression == 3;                              // not run-length encoded
  if (fixed && row * size.height > 0) b.byte(b.little32(10) + row * size.height - 1);
  return size;
}

// Requires the trailer, since libgif leaves the rest of a truncated file black.
PictureSize gif_size(const Bytes& b) {
  const std::size_t last = b.bytes.find_last_not_of('\0');
  if (last == std::string_view::npos || b.bytes[last] != ';') b.fail("the picture is truncated; save it again");
  return {b.little16(6), b.little16(8)};
}

}  // namespace

std::optional<PictureSize> size_in_header(const std::string& file, const std::string& bytes) {
  const Bytes b{file, bytes};
  if (bytes.starts_with("\xFF\xD8\xFF")) return jpeg_size(b);
  if (bytes.starts_with("BM")) return bmp_size(b);
  if (bytes.starts_with("GIF8")) return gif_size(b);
  return std::nullopt;
}

}  // namespace sf::world
