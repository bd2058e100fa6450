#pragma once
// Pictures as brightness: PNG (all colour types) and PGM (P2, P5).

#include <cstdint>
#include <string>
#include <vector>

namespace sf::world {

/// Row by row from the top.
struct Picture {
  std::uint32_t width = 0;           ///< [pixel] in [1, 16384]
  std::uint32_t height = 0;          ///< [pixel] in [1, 16384]
  std::vector<std::uint8_t> value;   ///< 0 black .. 255 white; deeper samples are scaled down
  std::vector<std::uint8_t> opaque;  ///< 0 where a pixel is more than half transparent, else 1; empty when no pixel is
};

/// The value taken from a coloured pixel: Stage uses the first channel, map_server the mean of red, green and blue.
enum class Channel { first, mean };

/// @throws base::InputError when the file is missing, broken, neither PNG nor PGM, or larger than 16384 x 16384.
Picture read_picture(const std::string& file, Channel channel);

/// Likewise from memory. @param file name for errors
Picture decode_picture(const std::string& file, const std::string& bytes, Channel channel);

}  // namespace sf::world
