// libFuzzer target: any bytes as a testbed file.

#include <cmath>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "vision/testbed.h"

using namespace sf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const vision::Testbed testbed = vision::parse_testbed("fuzz.toml", {reinterpret_cast<const char*>(data), size});
    require(!testbed.cameras.empty() && testbed.cameras.size() <= vision::kMaxCameras);
    for (const vision::TestbedCamera& each : testbed.cameras) {
      const vision::Intrinsics& i = each.camera.intrinsics;
      require(vision::is_camera_name(each.camera.name) && i.width >= 16 && i.height >= 16);
      require(std::int64_t{i.width} * i.height <= vision::kMaxImagePixels && each.camera.rate > 0.0);
      require(std::isfinite(i.focal.x + i.focal.y + i.center.x + i.center.y + each.camera.position.z));
    }
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).starts_with("fuzz.toml"));
  }
  return 0;
}
