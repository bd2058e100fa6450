#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "apps/commands/commands.h"
#include "apps/options/default_robot.h"
#include "apps/reports/text.h"
#include "apps/reports/v2x_json.h"
#include "base/error.h"
#include "base/files.h"
#include "server/signal_messages.h"
#include "v2x/text_forms.h"
#include "v2x/xml.h"
#include "world/roads/roads.h"

namespace sf::apps {

namespace {

constexpr std::size_t kMaxFrameFile = 64u << 20;  ///< [byte]
constexpr std::size_t kMaxComplaints = 10;
const std::string kXml = "<?xml version=\"1.0\"?>\n";

/// Returns the content of the file, or of standard input for `-`.
std::string content_of(const std::string& file) {
  if (file != "-") return base::read_bytes(file, kMaxFrameFile);
  std::string text;
  std::vector<char> part(1u << 16);
  while (std::cin.read(part.data(), static_cast<std::streamsize>(part.size())), std::cin.gcount() > 0) {
    text.append(part.data(), static_cast<std::size_t>(std::cin.gcount()));
    if (text.size() > kMaxFrameFile) throw base::InputError("-", 0, fmt::format("more than {} bytes", kMaxFrameFile));
  }
  if (text.empty()) throw base::InputError("-", 0, "standard input is empty; expected frames");
  return text;
}

/// Prints decoded frames, and errors for invalid ones.
class Decoder {
 public:
  explicit Decoder(const V2xOptions& options) : options_(options) {}

  /// Decodes the frame at the start of `bytes`. Returns its size, or the size of `bytes` after an error. @param line 0:
  /// a binary file
  std::size_t decode(std::span<const std::uint8_t> bytes, int line, bool is_alone) {
    v2x::Frame frame;
    const v2x::DecodeResult result = v2x::decode(bytes, frame);
    if (!result.ok()) return complain(line, bytes.size(), result.error);
    const bool is_last = is_alone || !is_frame(bytes.subspan(result.size));
    const std::span<const std::uint8_t> all = is_last ? bytes : bytes.first(result.size);
    frame.padding.assign(all.begin() + static_cast<std::ptrdiff_t>(result.size), all.end());
    v2x::encode(frame, again_);
    if (!std::equal(all.begin(), all.end(), again_.begin(), again_.end()))
      print_message("{}: encodes to other bytes, since its sender does not conform to X.691", place(line));
    ++frames_;
    if (options_.xml) {
      put_xml(frame);
    } else {
      print(v2x_frame_json(frame) + "\n");
    }
    return all.size();
  }
  std::size_t complain(int line, std::size_t size, const std::string& why) {
    if (++faults_ <= kMaxComplaints) print_message("{}: {}", place(line), why);
    return size;
  }
  int finish() {
    if (frames_ + faults_ == 0) throw base::InputError(options_.file, 0, "no frame in it");
    if (options_.xml && frames_ == 1) print(kXml + v2x::xml_of(first_));
    if (options_.xml && frames_ > 1) print("</MessageFrames>\n");
    if (faults_ > kMaxComplaints) print_message("{} more frames are not decoded", faults_ - kMaxComplaints);
    return faults_ == 0 ? 0 : 2;
  }

 private:
  /// True if `bytes` start like a message frame with SPaT or MAP.
  static bool is_frame(std::span<const std::uint8_t> bytes) {
    return bytes.size() > 3 && (bytes[0] & 0x7F) == 0 &&  // the first bit marks an extension
           (bytes[1] == v2x::Spat::kMessageId || bytes[1] == v2x::MapData::kMessageId);
  }
  std::string place(int line) const {
    return line > 0 ? fmt::format("{}:{}", options_.file, line)
                    : fmt::format("{}: frame {}", options_.file, frames_ + 1);
  }

  /// Several frames need an enclosing element, so the first is held back until the second arrives.
  void put_xml(const v2x::Frame& frame) {
    if (frames_ == 1) first_ = frame;
    if (frames_ == 2) print(kXml + "<MessageFrames>\n" + v2x::xml_of(first_, 1));
    if (frames_ > 1) print(v2x::xml_of(frame, 1));
  }

  const V2xOptions& options_;
  v2x::Frame first_;
  base::Bytes again_;
  std::size_t frames_ = 0, faults_ = 0;
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// True if the content consists of hexadecimal digits and whitespace, false if it is binary.
bool is_hex(const std::string& content) {
  const auto is_text = [](unsigned char c) { return (c >= 32 && c < 127) || is_blank(static_cast<char>(c)); };
  return std::all_of(content.begin(), content.end(), is_text);
}

void decode_line(Decoder& decoder, std::string line, int number) {
  line.erase(std::remove_if(line.begin(), line.end(), is_blank), line.end());
  if (line.empty() || line.front() == '#') return;
  if (line.starts_with("0x") || line.starts_with("0X")) line.erase(0, 2);
  const auto bytes = v2x::read_hex(line);
  if (!bytes && line.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos) {
    decoder.complain(number, 0, fmt::format("{} hexadecimal digits; expected two per byte", line.size()));
  } else if (!bytes) {
    decoder.complain(number, 0, "expected hexadecimal digits, one frame per line");
  } else {
    decoder.decode(*bytes, number, true);
  }
}

int decode(const V2xOptions& options) {
  const std::string content = content_of(options.file);
  Decoder decoder(options);
  if (is_hex(content)) {
    int number = 0;
    for (std::size_t at = 0; at < content.size();) {
      const std::size_t end = std::min(content.find('\n', at), content.size());
      decode_line(decoder, content.substr(at, end - at), ++number);
      at = end + 1;
    }
  } else {
    std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
    while (!bytes.empty()) bytes = bytes.subspan(decoder.decode(bytes, 0, false));
  }
  return decoder.finish();
}

int encode(const V2xOptions& options) {
  base::Bytes bytes;
  read_frames(options.file, content_of(options.file), [&](const v2x::Frame& frame) {
    v2x::encode(frame, bytes);
    if (bytes.size() > v2x::kMaxFrame)
      throw base::InputError(options.file, 0,
                             fmt::format("a frame of {} bytes; expected at most {}", bytes.size(), v2x::kMaxFrame));
    print(v2x::hex_text(bytes) + "\n");
  });
  return 0;
}

template <class Message>
void print_frame(Message message) {
  base::Bytes bytes;
  v2x::Frame frame;
  frame.message = std::move(message);
  v2x::encode(frame, bytes);
  print(v2x::hex_text(bytes) + "\n");
}

/// Writes MAP and SPaT of each intersection. Simulated time starts with the year.
int export_world(const V2xOptions& options) {
  const world::World world = load_lights(options.file);
  const auto roads = world::roads_of(world);
  for (const server::Intersection& one : server::intersections_of(world, roads ? &*roads : nullptr)) {
    std::vector<std::string> names;
    for (const std::uint32_t light : one.lights) names.push_back(world.lights[light].name);
    print_message("intersection {}: {}; {}", one.id, fmt::join(names, ", "), counted(one.stops.size(), "stop line"));
    if (roads)
      if (auto map = map_of(*roads, one, {options.latitude, options.longitude})) print_frame(std::move(*map));
    print_frame(spat_of(one, world::forecasts_at(world, options.time), std::llround(1e3 * options.time)));
  }
  return 0;
}

}  // namespace

int v2x_messages(const V2xOptions& options) {
  switch (options.action) {
    case V2xOptions::Action::decode:
      return decode(options);
    case V2xOptions::Action::encode:
      return encode(options);
    case V2xOptions::Action::export_world:
      break;
  }
  return export_world(options);
}

}  // namespace sf::apps
