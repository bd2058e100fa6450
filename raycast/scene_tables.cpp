// The device's tables: how they grow, and what of them travels.

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "raycast/scene_parts.h"

namespace sf::raycast {

namespace {

/// Robots drive on: of the cells that each of them left lately, so many are kept, and of few robots more.
constexpr SceneOptions kEach{.pool_chunks = 1u << 12, .pool_cells = 1u << 6};
constexpr SceneOptions kLeast{.pool_chunks = 1u << 16, .pool_cells = 1u << 10};

}  // namespace

ListTables Scene::tables() {
  return {entries_->host<ListEntry>().data(), ids_->host<std::uint32_t>().data(), nearest_->host<float>().data(),
          words_.data()};
}

void Scene::make_room(std::uint32_t carriers) {
  const auto room = [carriers](std::uint32_t each, std::uint32_t least, std::uint32_t most) {
    return static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(std::uint64_t{each} * carriers, std::min(least, most), most));
  };
  grow(room(kEach.pool_cells, kLeast.pool_cells, most_.pool_cells),
       room(kEach.pool_chunks, kLeast.pool_chunks, most_.pool_chunks), 64, 4096);
}

/// @return false when the device has no room for more
bool Scene::try_to_grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t mover_chunks) {
  try {
    grow(pool_cells, pool_chunks, view_capacity_, mover_chunks);
    return true;
  } catch (const base::DeviceError&) {
    return false;
  }
}

void Scene::grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t views, std::uint32_t mover_chunks) {
  const auto replace = [&](std::unique_ptr<gpu::Buffer>& table, const char* name, gpu::Texel texel,
                           std::size_t texels) {
    replaced_ = upload_all_ = true;
    auto larger = std::make_unique<gpu::Buffer>(device_, name, gpu::Role::upload, texel, texels);
    if (table) std::memcpy(larger->host<std::uint8_t>().data(), table->host<std::uint8_t>().data(), table->bytes());
    table = std::move(larger);
  };
  const std::size_t chunks = std::size_t{pool_chunks} + mover_chunks;
  if (chunks != std::size_t{options_.pool_chunks} + mover_chunks_ || !entries_) {
    replace(entries_, "sector lists", gpu::Texel::f32x4, SF_CHUNK * chunks);
    replace(ids_, "names in sector lists", gpu::Texel::u32, SF_CHUNK * chunks);
    replace(nearest_, "distances of chunks", gpu::Texel::f32, chunks);
  }
  if (pool_cells != options_.pool_cells || views != view_capacity_)
    replace(headers_, "heads of sector lists", gpu::Texel::u32x4, std::size_t{SF_SECTORS} * (pool_cells + views + 1));
  const auto nobody = headers_->host<ListHeader>().subspan(std::size_t{SF_SECTORS} * (pool_cells + views), SF_SECTORS);
  std::fill(nobody.begin(), nobody.end(), ListHeader{0, 0, std::numeric_limits<float>::infinity(), 0});
  cells_.grow(pool_cells, pool_chunks);
  too_long_.resize(pool_cells);
  options_ = {.pool_chunks = pool_chunks, .pool_cells = pool_cells};
  view_capacity_ = views;
  mover_chunks_ = mover_chunks;
}

void Scene::upload(gpu::Batch& batch) {
  const std::size_t pool = options_.pool_chunks;
  const auto chunks_up = [&](std::size_t first, std::size_t count) {
    batch.up(*entries_, first * SF_CHUNK * 16, count * SF_CHUNK * 16);
    batch.up(*ids_, first * SF_CHUNK * 4, count * SF_CHUNK * 4);
    batch.up(*nearest_, first * 4, count * 4);
  };
  if (upload_all_) {
    chunks_up(0, pool + mover_chunks_used_);
    batch.up(*headers_, 0, headers_->bytes());
    batch.up(*segments_, 0, segments_->bytes());
    batch.up(*models_, 0, models_->bytes());
  } else {
    for (const std::uint32_t slot : fresh_slots_) {
      const ListHeader* own = headers_->host<ListHeader>().data() + std::size_t{SF_SECTORS} * slot;
      const ListHeader& last = own[SF_SECTORS - 1];
      chunks_up(own->first, last.first + last.count + last.behind - own->first);
      batch.up(*headers_, std::size_t{SF_SECTORS} * slot * 16, SF_SECTORS * 16);
    }
    chunks_up(pool, mover_chunks_used_);
    batch.up(*headers_, std::size_t{SF_SECTORS} * options_.pool_cells * 16, groups_.size() * SF_SECTORS * 16);
    batch.up(*segments_, families_.walls().size() * sizeof(ExactSegment), bodies_->segments().size_bytes());
  }
  upload_all_ = false;
  fresh_slots_.clear();
}

}  // namespace sf::raycast
