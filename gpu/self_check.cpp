#include "gpu/self_check.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "shaders/self_check.comp.h"

namespace sf::gpu {

namespace {

struct Operands {
  double a;
  double b;
};

/// What shaders/self_check.comp computes for each row, in its order.
constexpr std::array<const char*, 6> kOperations = {
    "a + b", "a - b", "a * b", "a / b", "a * b - b * a * 0.9 (unfused)", "float(a)"};

std::array<double, 6> on_host(const Operands& o) {
  const double p = o.a * o.b;
  const double q = o.b * (o.a * 0.9);
  return {o.a + o.b, o.a - o.b, p, o.a / o.b, p - q, static_cast<double>(static_cast<float>(o.a))};
}

/// Pairs whose sums, products and quotients need every bit of the significand.
std::array<Operands, 64> operands() {
  std::array<Operands, 64> rows;
  double a = M_PI;
  double b = M_E;
  for (Operands& row : rows) {
    row = {a, b};
    a = std::fmod(a * 1.9999371 + b * 0.37, 1e5) + 1e-3;
    b = -b * 1.0437 + 1e-7 * a;
  }
  return rows;
}

}  // namespace

std::string self_check(Device& device) {
  const auto rows = operands();
  const std::size_t groups = rows.size() / 64;
  Kernel kernel(device, "self-check", self_check_comp_spv, 2);
  Buffer in(device, "operands", Role::upload, Texel::u32x4, rows.size());
  Buffer out(device, "results", Role::download, Texel::u32x4, rows.size() * kOperations.size() / 2);
  Buffer counts(device, "group counts", Role::upload, Texel::u32, 4);
  std::memcpy(in.host<std::uint32_t>().data(), rows.data(), sizeof rows);
  counts.host<std::uint32_t>()[0] = static_cast<std::uint32_t>(groups);
  counts.host<std::uint32_t>()[1] = counts.host<std::uint32_t>()[2] = 1;
  Buffer* const tables[] = {&in, &out};
  kernel.bind(tables);

  Batch batch(device);
  batch.begin();
  batch.dispatch(kernel, counts, 0);
  batch.end();
  batch.up(in, 0, in.bytes());
  batch.up(counts, 0, counts.bytes());
  batch.down(out, 0, out.bytes());
  batch.run();

  const auto results = out.host<double>();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto expected = on_host(rows[i]);
    for (std::size_t k = 0; k < expected.size(); ++k)
      if (std::bit_cast<std::uint64_t>(expected[k]) != std::bit_cast<std::uint64_t>(results[i * expected.size() + k]))
        return std::string("its 64-bit arithmetic differs from IEEE 754 in ") + kOperations[k];
  }
  return "";
}

}  // namespace sf::gpu
