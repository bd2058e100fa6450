// Kernels compute elementary functions to the byte as the host does (shaders/lib/elementary64.glsl).

#include "base/elementary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "base/pose.h"
#include "base/random.h"
#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "shaders/elementary.comp.h"
#include "tests/device.h"

namespace sf {
namespace {

constexpr std::array kNames{"sin",  "cos", "sinc",     "wrap_angle", "rint",
                            "ceil", "log", "copysign", "atan2 up",   "atan2 along"};

std::array<double, 10> expected_of(double x) {
  const auto [s, c] = base::sin_cos(x);
  return {s,
          c,
          base::sinc(x),
          base::wrap_angle(x),
          std::rint(x) + 0.0,
          std::ceil(std::abs(x)),
          base::log(std::max(std::abs(x), 1e-300)),
          std::copysign(1.0, x),
          base::atan2(x, 0.7),
          base::atan2(-0.3, x)};
}

/// Returns angles at and next to multiples of pi/2, around the threshold of sinc, and random ones, of both signs.
std::vector<double> angles() {
  std::vector<double> positive{0.0, 5e-324, 1e-300, 1e-9, 0.99e-4, 1e-4, 1.01e-4, 0.5, 1.5, 2.5, 99'999.5, 999'999.0};
  for (int n = 1; n < 2'000; n += n < 40 ? 1 : 37) {
    const double x = n * (M_PI / 2);
    for (const double at : {x, std::nextafter(x, 0.0), std::nextafter(x, 1e9), n * M_PI}) positive.push_back(at);
  }
  for (std::uint32_t k = 0; k < 20'000; ++k) {
    const auto u = base::random_uniform({.seed = 5, .a = k}, 0);
    positive.push_back(std::ldexp(u[0], static_cast<int>(40.0 * u[1]) - 20));
  }
  std::vector<double> all;
  for (const double x : positive) all.push_back(x), all.push_back(-x);
  return all;
}

TEST(ElementaryKernel, BytesOfTheHost) {
  using gpu::Role, gpu::Texel;
  std::vector<double> xs = angles();
  gpu::Kernel kernel(device(), "elementary", elementary_comp_spv);
  xs.resize(kernel.padded(xs.size()), 1.0);
  gpu::Buffer in(device(), "angles", Role::upload, Texel::u32x4, xs.size());
  gpu::Buffer out(device(), "results", Role::download, Texel::u32x4, 5 * xs.size());
  gpu::Buffer counts(device(), "counts", Role::upload, Texel::u32, 4);
  for (std::size_t i = 0; i < xs.size(); ++i) in.host<double>()[2 * i] = xs[i];
  counts.host<std::uint32_t>()[0] = static_cast<std::uint32_t>(xs.size() / kernel.group_size());
  counts.host<std::uint32_t>()[1] = counts.host<std::uint32_t>()[2] = 1;
  kernel.bind({{"angles", &in}, {"results", &out}});
  gpu::Batch batch(device());
  batch.begin();
  batch.dispatch(kernel, counts, 0);
  batch.end();
  batch.upload(in, 0, in.bytes()), batch.upload(counts, 0, counts.bytes());
  batch.download(out, 0, out.bytes());
  batch.run();
  const auto found = out.host<double>();
  for (std::size_t i = 0; i < xs.size(); ++i) {
    const auto expected = expected_of(xs[i]);
    for (std::size_t k = 0; k < expected.size(); ++k)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(expected[k]), std::bit_cast<std::uint64_t>(found[expected.size() * i + k]))
          << kNames[k] << " of " << xs[i] << " is " << expected[k] << ", not " << found[expected.size() * i + k];
  }
}

}  // namespace
}  // namespace sf
