#pragma once
/// Readings of a luxmeter in a hand: typed, taken from a file that the meter's own program writes, or from the page.

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "core/result.h"
#include "tools/luxrig/calibrate/hand_answer.h"
#include "tools/luxrig/calibrate/page_question.h"

namespace luxrig {

class HandMeter {
 public:
  /// file: where Enter alone takes the reading from; none = every reading is typed.
  /// page: asks there too, and the first answer counts. It has to outlive this.
  HandMeter(std::optional<std::filesystem::path> file, PageQuestion& page) : file_(std::move(file)), page_(page) {}

  [[nodiscard]] bool has_file() const { return file_.has_value(); }

  /// Asks until there is an answer: a reading, skip, other_place or done (also at the end of the input). what: at the
  /// terminal; the place was told before. waiting: called every `period` meanwhile; its fault ends the asking.
  [[nodiscard]] Result<HandAnswer> ask(const std::string& what, const HandQuestion& question,
                                       std::chrono::seconds period, const std::function<Result<void>()>& waiting,
                                       const std::stop_token& stop);

 private:
  enum class Line { whole, none_yet, end };
  [[nodiscard]] Line next_line(std::string& line);
  /// What a typed line says; none = it is told why not, and asked again.
  [[nodiscard]] std::optional<HandAnswer> answer_of(const std::string& line) const;
  /// The page's answer, told at the terminal.
  [[nodiscard]] HandAnswer from_page(const HandAnswer& answer);
  void tell_why_no_page();

  std::optional<std::filesystem::path> file_;
  PageQuestion& page_;
  std::string typed_;
  bool ended_ = false, told_why_no_page_ = false;
};

}  // namespace luxrig
