#pragma once
/// Median of very many relative errors, without storing them.

#include <array>
#include <cstdint>

namespace luxrig {

class ErrorHistogram {
 public:
  void add(double relative_error);
  void add(const ErrorHistogram& other);
  /// To 3 %; 0 when at least half are below 10⁻⁶.
  [[nodiscard]] double median() const;

 private:
  static constexpr std::size_t kBins = 640;  ///< 3 % each, from 10⁻⁶ to 160; the first also holds smaller ones
  std::array<std::uint64_t, kBins> counts_{};
};

}  // namespace luxrig
