#pragma once
// The two ways to cast rays: kernels of the device, and vectors of this machine. Both give the same bytes.

#include <cstdint>
#include <string>

namespace sf::raycast {

enum class CasterChoice : std::uint8_t {
  automatic,  ///< as `choose_caster` says
  vulkan,     ///< kernels on the device
  host,       ///< scan conversion on this machine
};

/// The caster where `asked` is automatic: the environment's SENSORFARM_CASTER ("vulkan" or "host"), else the host where
/// the device is software, which is slower at it, else Vulkan.
/// @throws base::InputError where the environment names another caster.
CasterChoice choose_caster(bool software, CasterChoice asked = CasterChoice::automatic);

/// The caster of farms on such a device as reports name it: "Vulkan kernels", or the host with its vectors, as in
/// "host, AVX2".
std::string describe_caster(bool software);

}  // namespace sf::raycast
