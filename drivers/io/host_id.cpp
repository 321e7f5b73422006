#include "drivers/io/host_id.h"

#include <unistd.h>

#include <array>
#include <fstream>

namespace luxrig {
namespace {

std::uint64_t fnv_1a(std::string_view text, std::uint64_t state) {
  for (const char letter : text) {  // FNV-1a
    state ^= static_cast<std::uint8_t>(letter);
    state *= 0x100000001b3ULL;
  }
  state ^= 0xFF;  // end of a part: ("ab", "c") differs from ("a", "bc")
  return state * 0x100000001b3ULL;
}

std::uint64_t mixed(std::uint64_t x) {  // splitmix64's finaliser: FNV alone mixes the high bits poorly
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

}  // namespace

std::string host_id() {
  std::string id;
  std::ifstream file("/etc/machine-id");
  if (std::getline(file, id) && !id.empty()) return id;
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) == 0) return name.data();
  return {};
}

std::array<std::uint8_t, 16> hashed_id(std::span<const std::string_view> parts) {
  std::array<std::uint8_t, 16> id{};
  for (std::size_t half = 0; half < 2; ++half) {
    std::uint64_t state = half == 0 ? 0xcbf29ce484222325ULL : 0x9ae16a3b2f90404fULL;
    for (const std::string_view part : parts) state = fnv_1a(part, state);
    state = mixed(state);
    for (std::size_t i = 0; i < 8; ++i) id[half * 8 + i] = static_cast<std::uint8_t>(state >> (56 - 8 * i));
  }
  return id;
}

}  // namespace luxrig
