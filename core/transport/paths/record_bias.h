#pragma once
/// Common bias of all irradiance records, measured by paths that continued beside their records.

#include <array>
#include <cstddef>
#include <optional>

namespace luxrig {

class RecordBias {
 public:
  static constexpr std::size_t kReplicates = 16;

  /// Light of the same paths by record and by path, in any unit.
  void add(std::size_t replicate, double by_record, double by_path) {
    by_record_[replicate] += by_record;
    by_path_[replicate] += by_path;
  }

  struct Estimate {
    double mean = 0;   ///< records give (1 + mean) times the light that paths find
    double error = 0;  ///< standard error of the mean
  };
  /// As measured; empty until every replicate has found light.
  [[nodiscard]] std::optional<Estimate> measured() const;
  /// Combined, weighted by certainty, with prior knowledge: records err by about a hundredth.
  [[nodiscard]] std::optional<Estimate> believed() const;

 private:
  std::array<double, kReplicates> by_record_{}, by_path_{};
};

}  // namespace luxrig
