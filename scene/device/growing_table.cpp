#include "scene/device/growing_table.h"

#include <algorithm>
#include <utility>

namespace sf::scene {

namespace {

constexpr std::size_t kFirstTexels = 64;

}  // namespace

GrowingTable::GrowingTable(gpu::Device& device, std::string_view name, gpu::Texel texel)
    : device_(device), name_(name), texel_(texel), buffer_(device, name, gpu::Role::upload, texel, kFirstTexels) {}

std::byte* GrowingTable::extend(std::size_t size) {
  const std::size_t needed = used_ + size;
  if (needed > buffer_.bytes()) {
    const std::size_t bytes = std::max(needed, 2 * buffer_.bytes()), texel = gpu::texel_size(texel_);
    gpu::Buffer larger(device_, name_, gpu::Role::upload, texel_, (bytes + texel - 1) / texel);
    std::memcpy(larger.host<std::byte>().data(), buffer_.host<std::byte>().data(), used_);
    buffer_ = std::move(larger);
    replaced_ = true, uploaded_ = 0;
  }
  return buffer_.host<std::byte>().data() + std::exchange(used_, needed);
}

bool GrowingTable::take_replaced() { return std::exchange(replaced_, false); }

void GrowingTable::upload(gpu::Batch& batch) {
  const std::size_t first = std::exchange(uploaded_, used_);
  if (used_ > first) batch.upload(buffer_, first, used_ - first);
}

}  // namespace sf::scene
