#pragma once
/// What a person answers who holds a luxmeter.

#include <optional>
#include <string>
#include <string_view>

namespace luxrig {

struct HandAnswer {
  enum class What { reading, from_file, skip, other_place, done };
  What what = What::done;
  double lux = 0;  ///< of a reading

  friend bool operator==(const HandAnswer&, const HandAnswer&) = default;
};

/// Direct sun is half of it; more is a slip.
inline constexpr double kMostLux = 200000;

/// What a person typed: "182", "182.5 lx", "182,5"; nothing: from the file; s, n, q. None = neither.
[[nodiscard]] std::optional<HandAnswer> hand_answer(std::string_view line);
/// For a person: "182.5 lx", "skip this lamp".
[[nodiscard]] std::string words_of(const HandAnswer& answer);
/// The last number in a text of a few lines, such as a meter's log; none = its last line with anything on it has none.
[[nodiscard]] std::optional<double> last_reading(std::string_view text);

}  // namespace luxrig
