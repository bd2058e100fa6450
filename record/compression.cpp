#include "record/compression.h"

#include <zstd.h>

#include <new>

#include "base/error.h"

namespace sf::record {

namespace {

/// Higher levels take twice the time and save less than 1 % of a recording (docs/recordings.md).
constexpr int kLevel = 1;

template <class T>
T* require(T* made) {
  if (made == nullptr) throw std::bad_alloc();
  return made;
}

}  // namespace

ZstdCompressor::ZstdCompressor() : context_(require(ZSTD_createCCtx())) {}
void ZstdCompressor::Free::operator()(ZSTD_CCtx_s* context) const { ZSTD_freeCCtx(context); }

void ZstdCompressor::compress(std::span<const std::uint8_t> in, base::Bytes& out) {
  out.resize(ZSTD_compressBound(in.size()));
  const std::size_t size = ZSTD_compressCCtx(context_.get(), out.data(), out.size(), in.data(), in.size(), kLevel);
  SF_CHECK(ZSTD_isError(size) == 0, ZSTD_getErrorName(size));
  out.resize(size);
}

void ZstdDecompressor::Free::operator()(ZSTD_DCtx_s* context) const { ZSTD_freeDCtx(context); }

bool ZstdDecompressor::decompress(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  if (context_ == nullptr) context_.reset(require(ZSTD_createDCtx()));
  return ZSTD_decompressDCtx(context_.get(), out.data(), out.size(), in.data(), in.size()) == out.size();
}

}  // namespace sf::record
