#include "core/transport/sobol.h"

namespace luxrig {
namespace {

struct Primitive {
  std::uint32_t degree;        ///< s of Joe and Kuo's table
  std::uint32_t coefficients;  ///< a
  std::array<std::uint32_t, 3> m;
};
constexpr std::array<Primitive, 3> kJoeKuo = {{{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}}};

constexpr std::array<std::uint32_t, 32> direction_numbers(std::uint32_t dimension) {
  std::array<std::uint32_t, 32> v{};
  if (dimension == 0) {
    for (std::uint32_t i = 0; i < 32; ++i) v[i] = 1u << (31 - i);
    return v;
  }
  const Primitive& p = kJoeKuo[dimension - 1];
  for (std::uint32_t i = 0; i < 32; ++i) {
    if (i < p.degree) {
      v[i] = p.m[i] << (31 - i);
      continue;
    }
    v[i] = v[i - p.degree] ^ (v[i - p.degree] >> p.degree);
    for (std::uint32_t k = 1; k < p.degree; ++k)
      if ((p.coefficients >> (p.degree - 1 - k)) & 1u) v[i] ^= v[i - k];
  }
  return v;
}

/// XOR of the direction numbers of one byte of the index: four look-ups instead of up to 32 steps.
using ByteTables = std::array<std::array<std::uint32_t, 256>, 4>;
constexpr ByteTables byte_tables(std::uint32_t dimension) {
  ByteTables tables{};
  const auto v = direction_numbers(dimension);
  for (std::uint32_t byte = 0; byte < 4; ++byte)
    for (std::uint32_t value = 0; value < 256; ++value)
      for (std::uint32_t bit = 0; bit < 8; ++bit)
        if ((value >> bit) & 1u) tables[byte][value] ^= v[8 * byte + bit];
  return tables;
}
constexpr std::array<ByteTables, 4> kTables = {byte_tables(0), byte_tables(1), byte_tables(2), byte_tables(3)};

constexpr std::uint32_t reversed(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(x);
}

/// A permutation in which each bit depends only on lower bits; on reversed bits it is a nested uniform (Owen) scramble.
/// The even multipliers of Laine and Karras, in Burley's order.
constexpr std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return x;
}
constexpr std::uint32_t owen_scrambled(std::uint32_t x, std::uint32_t seed) {
  return reversed(laine_karras(reversed(x), seed));
}

constexpr double unit_interval(std::uint32_t bits) { return bits * 0x1p-32; }

}  // namespace

std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
  // The finaliser of SplitMix64 (Steele, Lea, Flood 2014) over a Weyl step by each argument.
  std::uint64_t z = (a + 0x9e3779b97f4a7c15ull) * 0xd1342543de82ef95ull ^ b;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

std::uint32_t sobol_bits(std::uint32_t index, std::uint32_t dimension) {
  const ByteTables& t = kTables[dimension];
  return t[0][index & 255u] ^ t[1][(index >> 8) & 255u] ^ t[2][(index >> 16) & 255u] ^ t[3][index >> 24];
}

std::array<double, 2> SobolSequence::pair(std::uint32_t index, std::uint32_t set, std::uint32_t half) const {
  const std::uint64_t set_key = mixed(key_, set);
  const std::uint64_t scramble = mixed(set_key, 1 + half);
  const std::uint32_t shuffled = owen_scrambled(index, static_cast<std::uint32_t>(set_key));
  const std::uint32_t first = sobol_bits(shuffled, 2 * half), second = sobol_bits(shuffled, 2 * half + 1);
  return {unit_interval(owen_scrambled(first, static_cast<std::uint32_t>(scramble))),
          unit_interval(owen_scrambled(second, static_cast<std::uint32_t>(scramble >> 32)))};
}

std::array<double, 4> SobolSequence::set(std::uint32_t index, std::uint32_t set) const {
  const auto low = pair(index, set, 0), high = pair(index, set, 1);
  return {low[0], low[1], high[0], high[1]};
}

}  // namespace luxrig
