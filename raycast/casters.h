#pragma once
// The ray casters, one line each, and the choice among them by name.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sf::raycast {

class Caster;
struct CasterInputs;

/// A ray caster by its name.
struct CasterType {
  std::string_view name;     ///< word of `--caster`
  std::string_view summary;  ///< for the help text
  bool on_device = false;    ///< its kernels need a Vulkan device
  /// Its ranges are those of `intersect` (raycast/intersect.h) to the bit. All casters of which this is true return the
  /// same bytes; others agree with them within the sum of both bounds, but where a beam passes an end of a surface
  /// within these.
  bool same_bytes = true;
  /// Description for reports: the name, and what computes, such as "host, AVX2".
  std::string (*describe)();
  /// [m] largest error of a range of a beam that does not graze, without `single`; parameters as of `exact_bound`.
  double (*bound)(double range_max, double longest, double farthest);
  std::unique_ptr<Caster> (*make)(const CasterInputs& in);
};

// All casters, in the order of help texts. Each is defined in the source of its name.
// clang-format off
#define SF_CASTERS(caster) \
  caster(device_caster)    \
  caster(host_caster)      \
  caster(reference_caster)
// clang-format on

#define SF_DECLARE_CASTER(name) extern const CasterType name;
SF_CASTERS(SF_DECLARE_CASTER)
#undef SF_DECLARE_CASTER

std::span<const CasterType* const> casters();

/// Words of `--caster`: "auto", then the names of all casters.
std::vector<std::string> caster_words();

/// The caster of that name; null for "auto". @throws base::InputError for another word, with `where` before it
const CasterType* caster_named(std::string_view word, std::string_view where = "");

/// Resolves `asked`. For null: the one that the environment variable SENSORFARM_CASTER names; if that is unset or
/// "auto", the host on a software device (faster there), else the device.
/// @throws base::InputError where SENSORFARM_CASTER names no caster
const CasterType& choose_caster(bool software, const CasterType* asked = nullptr);

/// Description of the chosen caster for reports.
std::string describe_caster(bool software, const CasterType* asked = nullptr);

}  // namespace sf::raycast
