// libFuzzer target: any bytes as a file of outlines.

#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/outlines.h"

using namespace sf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int memory = ::memfd_create("outlines", 0);
  static const std::string file = "/proc/self/fd/" + std::to_string(memory);
  require(::ftruncate(memory, 0) == 0 && ::pwrite(memory, data, size, 0) == static_cast<ssize_t>(size));
  world::OutlineFile outlines;
  outlines.file = file;
  outlines.metres_per_unit = 1e-6;  // arcs of few chords
  outlines.surface.z_max = 3.0;
  try {
    std::vector<world::Warning> warnings;
    const auto check = [](std::span<const world::Segment> walls) {
      require(!walls.empty());
      for (std::size_t i = 0; i < walls.size(); ++i) {
        require(std::isfinite(walls[i].a.x + walls[i].a.y + walls[i].b.x + walls[i].b.y) && walls[i].a != walls[i].b);
        require(walls[i].z_min == 0.0 && walls[i].z_max >= 0.0);
        require(i == 0 || walls[i].a == walls[i - 1].b);
      }
      require(!walls.front().solid_left || walls.front().a == walls.back().b);
    };
    world::read_outlines(outlines, check, &warnings);
    require(warnings.size() < 32);  // four of each kind, and three of the whole file
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).starts_with(file));
  }
  return 0;
}
