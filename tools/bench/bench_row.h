#pragma once
/// One measurement, and the output of lists of them.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace luxrig {

struct BenchRow {
  std::string case_name, method;
  double error = 0;  ///< as a fraction; NaN = none, printed as an empty field
  double seconds = 0;
  std::optional<double> target_error, target_seconds;
  std::vector<std::pair<std::string, std::string>> further;  ///< columns that the suite adds, the same on each row
  std::optional<std::pair<double, double>> quartiles{};      ///< of the error, where it is a median: drawn, not listed

  /// Whether both targets are met; nothing if there is none.
  [[nodiscard]] std::optional<bool> met() const;
};

/// `case,method,error,seconds,target_error,target_seconds,met`, then the further columns.
[[nodiscard]] std::string csv_of(const std::vector<BenchRow>& rows);

/// The same, aligned for reading.
[[nodiscard]] std::string table_of(const std::vector<BenchRow>& rows);

/// Error over seconds, both logarithmic. One line per case and method, with bars from quartile to quartile. Returns an
/// empty string, or why it was not written.
[[nodiscard]] std::string write_plot(const std::vector<BenchRow>& rows, const std::string& title,
                                     const std::filesystem::path& file);

}  // namespace luxrig
