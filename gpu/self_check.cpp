#include "gpu/self_check.h"

#include <cstring>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "gpu/self_check_arithmetic.h"
#include "shaders/self_check.comp.h"

namespace sf::gpu {

SelfCheck self_check(Device& device) { return self_check(device, self_check_comp_spv); }

SelfCheck self_check(Device& device, std::span<const std::uint32_t> spirv) {
  const std::vector<Operands> rows = operands();
  Kernel kernel(device, "self-check", spirv);
  Buffer in(device, "operands", Role::upload, Texel::u32x4, rows.size());
  Buffer out(device, "results", Role::download, Texel::u32x4, rows.size() * operations().size() / 2);
  Buffer counts(device, "group counts", Role::upload, Texel::u32, 4);
  std::memcpy(in.host<std::uint32_t>().data(), rows.data(), rows.size() * sizeof(Operands));
  counts.host<std::uint32_t>()[0] = static_cast<std::uint32_t>(rows.size()) / kernel.group_size();
  counts.host<std::uint32_t>()[1] = counts.host<std::uint32_t>()[2] = 1;
  kernel.bind({{"operands", &in}, {"results", &out}});

  Batch batch(device);
  batch.begin();
  batch.dispatch(kernel, counts, 0);
  batch.end();
  batch.upload(in, 0, in.bytes());
  batch.upload(counts, 0, counts.bytes());
  batch.download(out, 0, out.bytes());
  batch.run();
  const std::span<const std::uint64_t> found = out.host<std::uint64_t>();
  return {first_difference(found), rounds32(found)};
}

}  // namespace sf::gpu
