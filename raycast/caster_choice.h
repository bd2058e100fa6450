#pragma once
// The two ray casters: Vulkan kernels on the device, and vector instructions on the host. Both return the same bytes.

#include <cstdint>
#include <string>

namespace sf::raycast {

enum class CasterChoice : std::uint8_t {
  automatic,  ///< decided by `choose_caster`
  vulkan,     ///< kernels on the device
  host,       ///< scan conversion on this machine
};

/// Resolves `asked`. For `automatic`: the environment variable SENSORFARM_CASTER ("vulkan" or "host"); if unset or
/// "auto", the host on a software device (faster there), else Vulkan.
/// @throws base::InputError where SENSORFARM_CASTER has another value
CasterChoice choose_caster(bool software, CasterChoice asked = CasterChoice::automatic);

/// Name of the chosen caster for reports: "Vulkan kernels", or the host with its instruction set, such as "host, AVX2".
std::string describe_caster(bool software);

}  // namespace sf::raycast
