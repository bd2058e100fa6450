#pragma once
// The worked examples of docs/packets.md, byte by byte.

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

#include "base/bytes.h"

namespace sf::test {

/// Returns the bytes below `<!-- example: NAME -->`; empty if there is no such example.
inline base::Bytes documented(const std::string& example) {
  std::ifstream file(SF_SOURCE_DIR "/docs/packets.md");
  std::string line;
  while (std::getline(file, line) && line != "<!-- example: " + example + " -->") {
  }
  std::getline(file, line);  // opening fence
  base::Bytes bytes;
  std::size_t end = 0;
  while (std::getline(file, line) && line != "```") {
    if (line == "*") continue;  // rows equal to the previous one, up to the next row's offset
    std::istringstream row(line);
    std::size_t offset = 0;
    row >> std::hex >> offset;
    if (end == 0 && offset > 0) bytes = documented("sonar");  // the header of plain readings
    while (end >= 16 && end < offset && bytes.size() < offset) bytes.push_back(bytes[bytes.size() - 16]);
    for (unsigned byte = 0; row >> std::hex >> byte; end = ++offset) {
      bytes.resize(std::max(bytes.size(), offset + 1));
      bytes[offset] = static_cast<std::uint8_t>(byte);
    }
  }
  bytes.resize(end);
  return bytes;
}

}  // namespace sf::test
