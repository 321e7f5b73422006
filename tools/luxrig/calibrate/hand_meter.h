#pragma once
/// Readings of a luxmeter in a hand: typed, or taken from a file that the meter's own program writes.

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "core/result.h"
#include "tools/luxrig/calibrate/hand_answer.h"

namespace luxrig {

class HandMeter {
 public:
  /// file: where Enter alone takes the reading from; none = every reading is typed.
  explicit HandMeter(std::optional<std::filesystem::path> file) : file_(std::move(file)) {}

  [[nodiscard]] bool has_file() const { return file_.has_value(); }

  /// Asks until there is an answer: a reading, skip, other_place or done (also at the end of the input). waiting: called
  /// every `period` meanwhile; its fault ends the asking.
  [[nodiscard]] Result<HandAnswer> ask(const std::string& what, std::chrono::seconds period,
                                       const std::function<Result<void>()>& waiting, const std::stop_token& stop);

 private:
  enum class Line { whole, none_yet, end };
  [[nodiscard]] Line next_line(std::string& line);

  std::optional<std::filesystem::path> file_;
  std::string typed_;
  bool ended_ = false;
};

}  // namespace luxrig
