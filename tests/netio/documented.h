#pragma once
// The worked examples of docs/packets.md, byte by byte.

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

#include "base/bytes.h"

namespace sf::test {

/// The bytes below `<!-- example: NAME -->`; empty without such an example.
inline base::Bytes documented(const std::string& example) {
  std::ifstream file(SF_SOURCE_DIR "/docs/packets.md");
  std::string line;
  while (std::getline(file, line) && line != "<!-- example: " + example + " -->") {
  }
  std::getline(file, line);  // opening fence
  base::Bytes bytes;
  while (std::getline(file, line) && line != "```") {
    std::istringstream row(line.substr(4));
    for (unsigned byte = 0; row >> std::hex >> byte;) bytes.push_back(static_cast<std::uint8_t>(byte));
  }
  return bytes;
}

}  // namespace sf::test
