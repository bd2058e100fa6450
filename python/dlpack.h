#pragma once
// DLPack capsules of memory that NumPy does not know (https://dmlc.github.io/dlpack, version 0.8).

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace sensorfarm::python {

/// DLTensor
struct DlTensor {
  void* data;
  std::int32_t device_type, device;
  std::int32_t axes;
  std::uint8_t code, bits;
  std::uint16_t lanes;
  std::int64_t *shape, *strides;  ///< [elements]
  std::uint64_t offset;           ///< [bytes]
};

constexpr std::int32_t kDlHost = 1, kDlCuda = 2;  // kDLCPU, kDLCUDA

/// DLManagedTensor
struct DlManaged {
  DlTensor tensor;
  void* context;
  void (*deleter)(DlManaged*);
};
/// Owns its shape and strides, and keeps its memory alive.
struct DlOwned : DlManaged {
  std::vector<std::int64_t> shape, strides;
  std::shared_ptr<const void> memory;
};

/// Returns a capsule of floating-point numbers in CUDA's memory. @param bits of a number
inline pybind11::capsule cuda_capsule(void* data, int device, int bits, std::vector<std::int64_t> shape,
                                      std::vector<std::int64_t> strides, std::shared_ptr<const void> memory) {
  auto* const made = new DlOwned{{}, std::move(shape), std::move(strides), std::move(memory)};
  made->tensor = {data,
                  kDlCuda,
                  device,
                  static_cast<std::int32_t>(made->shape.size()),
                  2,  // kDLFloat
                  static_cast<std::uint8_t>(bits),
                  1,
                  made->shape.data(),
                  made->strides.data(),
                  0};
  made->deleter = [](DlManaged* self) { delete static_cast<DlOwned*>(self); };
  // A consumer renames the capsule, and calls the deleter itself.
  return pybind11::capsule(static_cast<DlManaged*>(made), "dltensor", [](PyObject* capsule) {
    if (PyCapsule_IsValid(capsule, "dltensor") == 0) return;
    auto* const unused = static_cast<DlManaged*>(PyCapsule_GetPointer(capsule, "dltensor"));
    unused->deleter(unused);
  });
}

}  // namespace sensorfarm::python
