#pragma once
/// Stateless Owen-scrambled Sobol points: any sample of any replicate can be computed alone, so the evaluators are
/// deterministic for any number of threads.
///
/// Direction numbers: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional
/// projections", SIAM J. Sci. Comput. 30 (2008), dimensions 1 to 4. More dimensions are padded: each set of four is
/// an independently shuffled and scrambled copy (B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4),
/// 2020), with the hash in the family of S. Laine and T. Karras (2011).

#include <array>
#include <cstdint>

namespace luxrig {

/// Mixes two numbers into one; a bijection of `b` for each `a`.
[[nodiscard]] std::uint64_t mixed(std::uint64_t a, std::uint64_t b);

/// One replicate of a sequence of points in [0, 1)^∞. Replicates with different keys are independent.
class SobolSequence {
 public:
  static constexpr std::uint32_t kSetDimensions = 4;

  explicit SobolSequence(std::uint64_t key) : key_(key) {}

  /// Coordinates 4·set … 4·set + 3 of point `index`. Of the first 2^m points, each elementary interval in base 2
  /// of a pair (0, 1) or (2, 3) holds its exact share.
  [[nodiscard]] std::array<double, kSetDimensions> set(std::uint32_t index, std::uint32_t set) const;

  /// Only two of them, at less cost: coordinates 4·set + 2·half and the next; half is 0 or 1.
  [[nodiscard]] std::array<double, 2> pair(std::uint32_t index, std::uint32_t set, std::uint32_t half) const;

  /// 64 random bits of a point: a seed where no strata are needed.
  [[nodiscard]] std::uint64_t number(std::uint32_t index) const { return mixed(key_, 0x100000000ull + index); }

 private:
  std::uint64_t key_;
};

/// The unscrambled sequence, as 32-bit fractions; dimension 0…3. For tests.
[[nodiscard]] std::uint32_t sobol_bits(std::uint32_t index, std::uint32_t dimension);

}  // namespace luxrig
