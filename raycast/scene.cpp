#include "raycast/scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "raycast/clearance.h"
#include "raycast/scene_parts.h"

namespace sf::raycast {

namespace {

constexpr double kClearanceCap = 0.05;  ///< [m]

/// Lists for small cells are short, but each cell costs: a 32nd of the range suits a scanner of some hundred beams, few
/// beams are not worth so many (docs/performance.md).
double cell_size(double range, std::uint32_t beams) {
  const double fewer = std::clamp(std::sqrt(361.0 / std::max(1u, beams)), 1.0, 6.0);
  return std::clamp(fewer * range / 32.0, 1e-3, 4.0);
}

}  // namespace

Scene::Scene(const world::World& world, const Families& families, gpu::Device& device, base::Workers& workers,
             const SceneOptions& options, std::uint32_t carriers)
    : workers_(workers),
      device_(device),
      most_(options),
      options_{.pool_chunks = 0, .pool_cells = 0},
      families_(families),
      all_walls_(std::make_unique<Sight>(Sight::of_all_heights(families.walls(), 2.0))),
      cells_(families, cell_size, CellPool(0, 0)) {
  bodies_ = std::make_unique<Bodies>(world, all_walls_.get());
  for (unsigned i = 0; i < workers.threads(); ++i) scratch_.push_back(std::make_unique<Scratch>());

  // Exact segments: walls now, movers each tick.
  const std::vector<world::Segment>& walls = families.walls();
  const std::size_t count = walls.size() + bodies_->segments().size();
  segments_ = std::make_unique<gpu::Buffer>(device, "walls and movers in 64 bits", gpu::Role::upload, gpu::Texel::u32x4,
                                            2 * count + 2);
  models_ = std::make_unique<gpu::Buffer>(device, "whose walls", gpu::Role::upload, gpu::Texel::u32, count + 1);
  if (count >= SF_ROW_MASK)
    throw base::InputError("the world has " + std::to_string(count) + " segments; at most " +
                           std::to_string(SF_ROW_MASK - 1) + " are supported");
  const auto exact = segments_->host<ExactSegment>();
  const auto models = models_->host<std::uint32_t>();
  std::vector<float> clearances = wall_clearances(walls, kClearanceCap);
  own_clearances_ = bodies_->own_clearances(kClearanceCap);
  clearances.insert(clearances.end(), own_clearances_.begin(), own_clearances_.end());
  for (std::size_t i = 0; i < walls.size(); ++i) exact[i] = {walls[i].a.x, walls[i].a.y, walls[i].b.x, walls[i].b.y};
  for (std::uint32_t i = 0; i < count; ++i) {
    models[i] = i < walls.size() ? walls[i].model : bodies_->models()[i - walls.size()];
    words_.push_back(list_word(i, clearances[i]));
  }

  add_tables();
  make_room(carriers);
}

Scene::~Scene() = default;

void Scene::add_tables() {
  for (std::size_t i = 0; i < families_.size(); ++i) {
    const Family& family = families_[i];
    const Sight& sight = families_.sight(i);
    // Only movers are looked up in it.
    auto& depth = depths_[&sight];
    if (!depth && bodies_->count() > 1) depth = std::make_unique<Depth>(sight);
    tables_of_.push_back({family.range,
                          family.fov,
                          {cells_.size_of(i), family.range, family.spread + 5e-4},
                          &sight,
                          depth.get(),
                          bodies_->watch_height(family.z)});
  }
}

void Scene::place(std::span<const Pose> poses) {
  bodies_->place(poses, workers_);
  const auto moved = bodies_->segments();
  if (!moved.empty())
    std::memcpy(segments_->host<ExactSegment>().data() + families_.walls().size(), moved.data(), moved.size_bytes());
  for (std::uint32_t row = 0; row < moved.size(); ++row)
    words_[families_.walls().size() + row] = list_word(static_cast<std::uint32_t>(families_.walls().size()) + row,
                                                       std::min(own_clearances_[row], bodies_->clearance_of(row)));
}

bool Scene::serve(std::span<const Viewpoint> views, std::span<RayRow> rows) {
  replaced_ = false;
  for_host_.assign(views.size(), 0);
  cells_.find(views, workers_);
  bool room = true;
  for (build_missing(); !cells_.missing().empty() && room && options_.pool_chunks < kMostPoolChunks; build_missing())
    room = try_to_grow(2 * options_.pool_cells + 64, std::min(2 * options_.pool_chunks + 4096, kMostPoolChunks),
                       mover_chunks_);

  find_groups(views);
  if (groups_.size() > view_capacity_)
    grow(options_.pool_cells, options_.pool_chunks, static_cast<std::uint32_t>(2 * groups_.size()), mover_chunks_);
  room = true;
  while (!fill_some_movers(views, room))
    room = try_to_grow(options_.pool_cells, options_.pool_chunks, 2 * mover_chunks_used_);
  workers_.run(views.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) fill_walls(views[i], i, rows[i]);
  });
  name_movers(views, rows);
  return replaced_;
}

Scene::Counts Scene::counts() const {
  Counts counts{cells_.pool().built(), cells_.pool().cells()};
  for (const auto& scratch : scratch_) {
    counts.movers_near += scratch->bodies.movers_near;
    counts.movers_met += scratch->bodies.movers_met;
  }
  return counts;
}

}  // namespace sf::raycast
