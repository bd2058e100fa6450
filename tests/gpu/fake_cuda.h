#pragma once
// Uses the libcuda of the tests (tests/gpu/fake_cuda.cpp) with devices that have memory of their own.

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

namespace sf::gpu {

class FakeCuda {
 public:
  FakeCuda() {
    setenv("SENSORFARM_LIBCUDA", kLibrary, 1);
    setenv("SENSORFARM_STAGING", "1", 1);
  }
  ~FakeCuda() {
    for (const char* name : {"SENSORFARM_LIBCUDA", "SENSORFARM_STAGING", "FAKE_CUDA_UUID"}) unsetenv(name);
  }
  FakeCuda(const FakeCuda&) = delete;
  FakeCuda& operator=(const FakeCuda&) = delete;

  /// Gives CUDA's device a UUID, with some bits of the last byte changed.
  static void name_device(std::span<const std::uint8_t> uuid, std::uint8_t changed = 0) {
    std::string text;
    for (const std::uint8_t byte : uuid) text += fmt::format("{:02x}", byte);
    text.replace(30, 2, fmt::format("{:02x}", uuid.back() ^ changed));
    setenv("FAKE_CUDA_UUID", text.c_str(), 1);
  }
  static int held() { return asked<int>("fake_cuda_held"); }  ///< contexts, memories and mappings in use

  /// Finds a table in the memory mapped last. A file of lavapipe begins with a header, unlike one of NVIDIA's.
  template <class Value>
  static Value* find(void* data, std::span<const Value> values) {
    auto* const first = static_cast<Value*>(data);
    auto* const end = first + asked<std::size_t>("fake_cuda_size") / sizeof(Value);
    auto* const found = std::search(first, end, values.begin(), values.end());
    return found == end ? nullptr : found;
  }

 private:
  static constexpr const char* kLibrary = SF_BINARY_DIR "/tests/libfake_cuda.so";
  template <class Value>
  static Value asked(const char* name) {
    void* const library = dlopen(kLibrary, RTLD_NOW | RTLD_NOLOAD);
    const auto function = library == nullptr ? nullptr : reinterpret_cast<Value (*)()>(dlsym(library, name));
    return function == nullptr ? Value{} : function();
  }
};

}  // namespace sf::gpu
