#pragma once
// GDAL's messages and network requests within the plug-in.

#include <string>

namespace sf::world {

/// While a Guard exists, GDAL's messages in this thread are collected, and its network requests fail: a GeoJSON file
/// may refer to its coordinate system by a URL.
class Guard {
 public:
  explicit Guard(std::string& messages);
  ~Guard();
  Guard(const Guard&) = delete;
};

}  // namespace sf::world
