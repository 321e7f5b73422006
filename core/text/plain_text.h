#pragma once
/// What of a person's text may be kept and shown: names end up in terminals, in JSON and on a page.

#include <string>
#include <string_view>

namespace luxrig {

/// Whether a text is sound UTF-8 without control characters.
[[nodiscard]] bool is_plain_text(std::string_view text);

/// Characters, not bytes, of sound UTF-8.
[[nodiscard]] std::size_t length_in_characters(std::string_view text);

inline constexpr std::size_t kLongestName = 100;  ///< characters

/// `text` with ? for whatever is not plain.
[[nodiscard]] std::string made_plain(std::string_view text);

/// The same in double quotes, cut after 60 characters.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace luxrig
