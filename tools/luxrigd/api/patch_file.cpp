#include "tools/luxrigd/api/patch_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/check.h"

namespace luxrig {
namespace {

void put_bits(std::string& bytes, std::uint64_t bits, int count) {
  for (int byte = 0; byte < count; ++byte) bytes += static_cast<char>(bits >> (8 * byte) & 0xff);
}
void put_float(std::string& bytes, float value) { put_bits(bytes, std::bit_cast<std::uint32_t>(value), 4); }
void put_double(std::string& bytes, double value) { put_bits(bytes, std::bit_cast<std::uint64_t>(value), 8); }

}  // namespace

std::string patch_file(const SurfacePatches& surface, std::span<const float> lux, const std::string& version) {
  LUXRIG_CHECK(version.size() == 16 && lux.size() == surface.size(), "{} {}", version, lux.size());
  const double cell_m = surface.grid.cell_m();
  std::string bytes = "LXP1";
  bytes.reserve(64 + 20 * surface.size());
  put_bits(bytes, surface.size(), 4);
  put_double(bytes, cell_m);
  for (const double at_m : surface.origin_world_m) put_double(bytes, at_m);
  bytes += version;
  put_bits(bytes, 0, 8);
  for (const SurfacePatch& patch : surface.patches) {
    for (const float at_m : patch.position_m) put_float(bytes, at_m);
    for (const float part : patch.normal)
      put_bits(bytes, static_cast<std::uint8_t>(static_cast<std::int8_t>(std::lround(127 * part))), 1);
    const double edge = std::sqrt(static_cast<double>(patch.area_m2)) / cell_m;
    put_bits(bytes, static_cast<std::uint64_t>(std::clamp(std::lround(128 * edge), 1L, 255L)), 1);
  }
  for (const float one : lux) put_float(bytes, one);
  return bytes;
}

}  // namespace luxrig
