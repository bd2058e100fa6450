#pragma once
// The golden packets in tests/netio/vectors/, which the farm and the clients in examples/clients/ must encode and
// decode.
//
// A file has the packets of one type, separated by empty lines: comments (#), `key = value` lines and, below `hex =`,
// the bytes. Numbers have ten significant digits. In statuses.txt the only key is the packet's status, and the bytes
// are edits of another packet:
//
//   like = laser 0         the first packet of laser.txt
//   size = 76              truncated, or padded with zeros
//   at 72 = ab ab x 2      bytes from offset 72, twice

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/bytes.h"

namespace sf::test {

struct PacketVector {
  std::string file;
  std::string text;  ///< the lines of keys and values
  base::Bytes bytes;
};

/// Paths of all files, in order.
inline std::vector<std::string> vector_files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(SF_SOURCE_DIR "/tests/netio/vectors"))
    files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<PacketVector> read_vectors(const std::string& path);

/// Applies a line that edits a packet. @return false for any other line
inline bool edit(const std::string& line, const std::string& path, base::Bytes& bytes) {
  std::istringstream row(line);
  std::string word, equals;
  std::size_t at = 0, times = 1;
  row >> word;
  if (word == "like" && row >> equals >> word >> at) {
    bytes = read_vectors(std::filesystem::path(path).replace_filename(word + ".txt").string()).at(at).bytes;
  } else if (word == "size" && row >> equals >> at) {
    bytes.resize(at);
  } else if (word == "at" && row >> at >> equals) {
    base::Bytes piece;
    for (; row >> word && word != "x";) piece.push_back(static_cast<std::uint8_t>(std::stoul(word, nullptr, 16)));
    for (row >> times; times-- > 0; at += piece.size())
      std::copy(piece.begin(), piece.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
  } else {
    return false;
  }
  return true;
}

inline std::vector<PacketVector> read_vectors(const std::string& path) {
  std::vector<PacketVector> vectors;
  std::ifstream file(path);
  bool open = false;  // a packet is being read
  for (std::string line; std::getline(file, line);) {
    if (line.empty()) open = false;
    if (line.empty() || line[0] == '#' || line == "hex =") continue;
    if (!open) vectors.push_back({path, "", {}});
    open = true;
    if (edit(line, path, vectors.back().bytes)) continue;
    std::istringstream row(line);
    if (line[0] != ' ') vectors.back().text += line + "\n";
    if (line[0] == ' ')
      for (unsigned byte = 0; row >> std::hex >> byte;) vectors.back().bytes.push_back(static_cast<std::uint8_t>(byte));
  }
  return vectors;
}

}  // namespace sf::test
