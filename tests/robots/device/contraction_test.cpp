// No kernel that moves a fleet or casts from its poses lets the device fuse a product with a sum, which would change
// the last bit; nor does the kernel of spatial scans in 64 bits.

#include <gtest/gtest.h>

#include <set>
#include <span>

#include "shaders/fleet_advance.comp.h"
#include "shaders/fleet_commit.comp.h"
#include "shaders/fleet_contacts.comp.h"
#include "shaders/fleet_index.comp.h"
#include "shaders/fleet_start.comp.h"
#include "shaders/observe.comp.h"
#include "shaders/pose_scans.comp.h"
#include "shaders/scene_tiles.comp.h"

namespace sf {
namespace {

/// Number of sums, differences and products in a module, and of those that the device may fuse.
struct Arithmetic {
  std::size_t all = 0;
  std::size_t fusible = 0;
};

/// @param only64 counts only operations whose results are of 64 bits
Arithmetic arithmetic_of(std::span<const std::uint32_t> spirv, bool only64 = false) {
  constexpr std::uint32_t kDecorate = 71, kNoContraction = 42, kTypeFloat = 22, kTypeVector = 23;
  std::set<std::uint32_t> types64;
  const std::set<std::uint32_t> kOperations{129, 131, 133, 142, 148};  // FAdd, FSub, FMul, VectorTimesScalar, Dot
  Arithmetic count;
  std::set<std::uint32_t> exact;
  for (std::size_t at = 5; at < spirv.size(); at += spirv[at] >> 16) {
    const std::uint32_t opcode = spirv[at] & 0xFFFFu;
    if (opcode == kDecorate && spirv[at + 2] == kNoContraction) exact.insert(spirv[at + 1]);
    if (opcode == kTypeFloat && spirv[at + 2] == 64) types64.insert(spirv[at + 1]);
    if (opcode == kTypeVector && types64.count(spirv[at + 2]) > 0) types64.insert(spirv[at + 1]);
    if (kOperations.count(opcode) == 0 || (only64 && types64.count(spirv[at + 1]) == 0)) continue;
    ++count.all;
    if (exact.count(spirv[at + 2]) == 0) ++count.fusible;
  }
  return count;
}

TEST(Contraction, KernelsOfAFleetAndItsScansFuseNothing) {
  const Arithmetic start = arithmetic_of(fleet_start_comp_spv), advance = arithmetic_of(fleet_advance_comp_spv),
                   commit = arithmetic_of(fleet_commit_comp_spv), contacts = arithmetic_of(fleet_contacts_comp_spv),
                   index = arithmetic_of(fleet_index_comp_spv), scans = arithmetic_of(pose_scans_comp_spv),
                   observe = arithmetic_of(observe_comp_spv);
  EXPECT_GT(start.all, 30u);
  EXPECT_GT(advance.all, 150u);
  EXPECT_GT(contacts.all, 80u);
  for (const Arithmetic& kernel : {start, index, advance, commit, contacts, scans, observe})
    EXPECT_EQ(kernel.fusible, 0u);
}

TEST(Contraction, SpatialScansFuseNothingIn64Bits) {
  const Arithmetic tiles = arithmetic_of(scene_tiles_comp_spv, true);
  EXPECT_GT(tiles.all, 5u);
  EXPECT_EQ(tiles.fusible, 0u);
}

}  // namespace
}  // namespace sf
