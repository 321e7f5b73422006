#pragma once
/// Restricts a person's text to what can be stored and shown: names end up in terminals, in JSON and on a page.

#include <string>
#include <string_view>

namespace luxrig {

/// Whether a text is valid UTF-8 without control characters.
[[nodiscard]] bool is_plain_text(std::string_view text);

/// Number of characters, not bytes, in valid UTF-8.
[[nodiscard]] std::size_t length_in_characters(std::string_view text);

inline constexpr std::size_t kLongestName = 100;  ///< characters

/// `text` with every character that is not plain replaced by ?.
[[nodiscard]] std::string made_plain(std::string_view text);

/// The same in double quotes, cut after 60 characters.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// As text of an HTML or XML element, or as an attribute's value in double quotes.
[[nodiscard]] std::string escaped_for_markup(std::string_view text);

}  // namespace luxrig
