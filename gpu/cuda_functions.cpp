#include "gpu/cuda_functions.h"

#include <dlfcn.h>

#include <cstdlib>

namespace sf::gpu {

namespace {

template <class Function>
bool find_in(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  return function != nullptr;
}

bool find_all(void* library, CudaFunctions& f) {
  return find_in(library, "cuInit", f.init) && find_in(library, "cuDeviceGetCount", f.count) &&
         find_in(library, "cuDeviceGet", f.get) && find_in(library, "cuDeviceGetUuid", f.uuid) &&
         find_in(library, "cuDevicePrimaryCtxRetain", f.retain) &&
         find_in(library, "cuDevicePrimaryCtxRelease_v2", f.release) &&
         find_in(library, "cuCtxPushCurrent_v2", f.push) && find_in(library, "cuCtxPopCurrent_v2", f.pop) &&
         find_in(library, "cuImportExternalMemory", f.import) &&
         find_in(library, "cuExternalMemoryGetMappedBuffer", f.map) && find_in(library, "cuMemFree_v2", f.unmap) &&
         find_in(library, "cuDestroyExternalMemory", f.destroy);
}

CudaFunctions opened_cuda() {
  const char* const named = std::getenv("SENSORFARM_LIBCUDA");
  void* const library = dlopen(named != nullptr ? named : "libcuda.so.1", RTLD_NOW | RTLD_LOCAL);
  CudaFunctions functions;
  if (library == nullptr || !find_all(library, functions) || functions.init(0) != 0) return {};
  return functions;
}

}  // namespace

const CudaFunctions* open_cuda() {
  static const CudaFunctions functions = opened_cuda();
  return functions.init == nullptr ? nullptr : &functions;
}

}  // namespace sf::gpu
