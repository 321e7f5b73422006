#pragma once
/// How far tail records are off, all of them together: from paths that were followed beside their records.

#include <array>
#include <cstddef>
#include <optional>

namespace luxrig {

class RecordBias {
 public:
  static constexpr std::size_t kReplicates = 16;

  /// Light by record and by path of the same paths, in any unit.
  void add(std::size_t replicate, double by_record, double by_path) {
    by_record_[replicate] += by_record;
    by_path_[replicate] += by_path;
  }

  struct Estimate {
    double mean = 0;   ///< records say (1 + mean) times what paths find
    double error = 0;  ///< standard error of the mean
  };
  /// As measured; nothing until every replicate has found light.
  [[nodiscard]] std::optional<Estimate> measured() const;
  /// Weighed, by its certainty, with what is known beforehand: that records err by a hundredth or so.
  [[nodiscard]] std::optional<Estimate> believed() const;

 private:
  std::array<double, kReplicates> by_record_{}, by_path_{};
};

}  // namespace luxrig
