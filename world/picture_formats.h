#pragma once
// The decoders behind world/picture.h. All throw base::InputError for a broken picture.

#include <cstdint>
#include <optional>
#include <string>

#include "world/picture.h"

namespace sf::world {

/// Largest number of pixels of pictures that are decoded as a whole, which takes several times their size: interlaced
/// PNG, JPEG, BMP, GIF.
inline constexpr std::size_t kMaxWhole = 1u << 26;

/// @throws base::InputError for more than kMaxWhole pixels, with `kind` ("an interlaced picture") in the message
void check_whole(const PictureSink& picture, const char* kind);

void decode_png(const std::string& bytes, PictureSink& out);
/// Decodes P1 to P6.
void decode_netpbm(const std::string& bytes, PictureSink& out);

struct PictureSize {
  std::uint64_t width = 0, height = 0;  ///< [pixel]
};

/// Returns the size in the header of a JPEG, BMP or GIF; nullopt for other formats. Checks the whole structure of a
/// JPEG, since libjpeg fills missing parts with grey.
std::optional<PictureSize> size_in_header(const std::string& file, const std::string& bytes);

}  // namespace sf::world
