#pragma once
// The two ways to cast rays: kernels of the device, and vectors of this machine. Both give the same bytes.

#include <cstdint>
#include <string>

namespace sf::raycast {

enum class Caster : std::uint8_t {
  automatic,  ///< as `caster_for` says
  vulkan,     ///< kernels on the device
  host,       ///< scan conversion on this machine
};

/// The caster where `asked` is automatic: the environment's SENSORFARM_CASTER ("vulkan" or "host"), else the host where
/// the device is software, which is slower at it, else Vulkan.
/// @throws base::InputError where the environment names another caster.
Caster caster_for(bool software, Caster asked = Caster::automatic);

/// The caster of farms on such a device as reports name it: "Vulkan kernels", or the host with its vectors, as in
/// "host, AVX2".
std::string caster_text(bool software);

}  // namespace sf::raycast
