#pragma once
// One submission per tick: uploads, kernels, downloads. The host may work between `submit` and `wait`.

#include <cstddef>
#include <memory>

#include "gpu/buffer.h"
#include "gpu/device.h"
#include "gpu/kernel.h"

namespace sf::gpu {

/// Kernels are recorded once. Copies are listed every tick, and cost nothing on unified devices. A batch on the host
/// device is empty. Not thread-safe.
class Batch {
 public:
  explicit Batch(Device& device);
  ~Batch();
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  /// Starts a new recording. Call it before the first `submit` and after replacing kernels or tables, but not between
  /// `submit` and `wait`. Recorded kernels and tables must live until the next `begin`.
  void begin();
  /// Runs `kernel` with the group counts (x, y, z as u32) found in `counts` at `offset` [bytes] when `run` is called.
  void dispatch(const Kernel& kernel, const Buffer& counts, std::size_t offset);
  /// Makes the results of earlier dispatches visible to later ones, including their group counts.
  void barrier();
  void end();

  /// Copies [offset, offset + size) [bytes] of `table` at the next `run`: `upload` from the host view to the device,
  /// `download` back.
  void upload(const Buffer& table, std::size_t offset, std::size_t size);
  void download(const Buffer& table, std::size_t offset, std::size_t size);

  /// Submits the recorded kernels and the copies listed since the last submission. The host must not access their
  /// tables until `wait` returns.
  void submit();
  /// Waits for the end of the submission; returns at once if there is none.
  void wait();
  void run() { submit(), wait(); }

  struct Vk;

 private:
  std::unique_ptr<Vk> vk_;
};

}  // namespace sf::gpu
